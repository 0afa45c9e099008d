#include "pilotage/vision/correlation_kernels.h"

#include <array>
#include <cstdint>
#include <cstring>
#include <limits>

namespace pilotage {
namespace {

using Float8 [[gnu::vector_size(32)]] = float;
using Int8 [[gnu::vector_size(32)]] = std::int32_t;

// Each loop is written once and inlined into a version for AVX2 and one for any processor.

[[gnu::always_inline]] inline void load(const float* from, Float8& to) {
  std::memcpy(&to, from, sizeof(to));
}
[[gnu::always_inline]] inline void store(const Float8& from, float* to) {
  std::memcpy(to, &from, sizeof(from));
}

[[gnu::always_inline]] inline void multiply_conjugate_loop(const float* a, const float* b, std::size_t count,
                                                           float* out) {
  const Float8 sign = {1, -1, 1, -1, 1, -1, 1, -1};
  for (std::size_t i = 0; i < 2 * count; i += 8) {
    Float8 x;
    Float8 y;
    load(a + i, x);
    load(b + i, y);
    const Float8 real = __builtin_shufflevector(x, x, 0, 0, 2, 2, 4, 4, 6, 6);
    const Float8 imaginary = __builtin_shufflevector(x, x, 1, 1, 3, 3, 5, 5, 7, 7);
    const Float8 swapped = __builtin_shufflevector(y, y, 1, 0, 3, 2, 5, 4, 7, 6);
    store(real * y + sign * (imaginary * swapped), out + i);
  }
}

[[gnu::always_inline]] inline void add_four_loop(const float* a, const float* b, const float* c, const float* d,
                                                 std::size_t count, float* out) {
  std::size_t i = 0;
  for (; i + 8 <= count; i += 8) {
    Float8 va;
    Float8 vb;
    Float8 vc;
    Float8 vd;
    load(a + i, va);
    load(b + i, vb);
    load(c + i, vc);
    load(d + i, vd);
    store(((va + vb) + vc) + vd, out + i);
  }
  for (; i < count; ++i) out[i] = ((a[i] + b[i]) + c[i]) + d[i];
}

[[gnu::always_inline]] inline void add_to_loop(const float* more, std::size_t count, float* values) {
  std::size_t i = 0;
  for (; i + 8 <= count; i += 8) {
    Float8 a;
    Float8 b;
    load(values + i, a);
    load(more + i, b);
    store(a + b, values + i);
  }
  for (; i < count; ++i) values[i] += more[i];
}

[[gnu::always_inline]] inline void normalise_loop(const float* window_sum, const float* inverse_norm, float mean,
                                                  float scale, std::size_t count, float* values) {
  const Float8 one = {1, 1, 1, 1, 1, 1, 1, 1};
  std::size_t i = 0;
  for (; i + 8 <= count; i += 8) {
    Float8 value;
    Float8 sum;
    Float8 norm;
    load(values + i, value);
    load(window_sum + i, sum);
    load(inverse_norm + i, norm);
    value = (value - mean * sum) * (scale * norm);
    value = value > one ? one : value;
    value = value < -one ? -one : value;
    store(value, values + i);
  }
  for (; i < count; ++i) {
    float value = (values[i] - mean * window_sum[i]) * (scale * inverse_norm[i]);
    value = value > 1 ? 1 : value;
    values[i] = value < -1 ? -1 : value;
  }
}

/// Eight lanes of sums.
struct Lanes {
  Float8 sum{};
  Float8 squares{};
  Int8 missing{};  // minus the number of numbers that are not NaN
  Float8 high{};
};

[[gnu::always_inline]] inline void add_lanes(const float* values, Lanes& lanes) {
  Float8 value;
  load(values, value);
  const Int8 there = value == value;  // all bits set where it is a number
  const Float8 zero{};
  const Float8 known = there ? value : zero;
  lanes.missing += there;
  lanes.sum += known;
  lanes.squares += known * known;
  lanes.high = value > lanes.high ? value : lanes.high;
}

[[gnu::always_inline]] inline SpanSums sum_span_loop(const float* values, std::size_t count) {
  constexpr float kLowest = -std::numeric_limits<float>::infinity();
  const Float8 lowest = {kLowest, kLowest, kLowest, kLowest, kLowest, kLowest, kLowest, kLowest};
  Lanes even;
  Lanes odd;
  even.high = lowest;
  odd.high = lowest;
  std::size_t i = 0;
  for (; i + 16 <= count; i += 16) {
    add_lanes(values + i, even);
    add_lanes(values + i + 8, odd);
  }
  if (i < count) {  // what is left, filled up with NaN
    std::array<float, 16> rest;
    rest.fill(std::numeric_limits<float>::quiet_NaN());
    std::memcpy(rest.data(), values + i, (count - i) * sizeof(float));
    add_lanes(rest.data(), even);
    add_lanes(rest.data() + 8, odd);
  }
  SpanSums sums;
  sums.highest = kLowest;
  for (int lane = 0; lane < 8; ++lane) {
    sums.sum += static_cast<double>(even.sum[lane]) + static_cast<double>(odd.sum[lane]);
    sums.squares += static_cast<double>(even.squares[lane]) + static_cast<double>(odd.squares[lane]);
    sums.count -= even.missing[lane] + odd.missing[lane];
    if (even.high[lane] > sums.highest) sums.highest = even.high[lane];
    if (odd.high[lane] > sums.highest) sums.highest = odd.high[lane];
  }
  return sums;
}

#if defined(__x86_64__)
[[gnu::target("avx2")]] void multiply_conjugate_avx2(const float* a, const float* b, std::size_t count, float* out) {
  multiply_conjugate_loop(a, b, count, out);
}
[[gnu::target("avx2")]] void add_four_avx2(const float* a, const float* b, const float* c, const float* d,
                                           std::size_t count, float* out) {
  add_four_loop(a, b, c, d, count, out);
}
[[gnu::target("avx2")]] void add_to_avx2(const float* more, std::size_t count, float* values) {
  add_to_loop(more, count, values);
}
[[gnu::target("avx2")]] void normalise_avx2(const float* window_sum, const float* inverse_norm, float mean, float scale,
                                            std::size_t count, float* values) {
  normalise_loop(window_sum, inverse_norm, mean, scale, count, values);
}
[[gnu::target("avx2")]] SpanSums sum_span_avx2(const float* values, std::size_t count) {
  return sum_span_loop(values, count);
}
bool has_avx2() {
  static const bool has = __builtin_cpu_supports("avx2") != 0;
  return has;
}
#endif

}  // namespace

void multiply_conjugate(const float* a, const float* b, std::size_t count, float* out) {
#if defined(__x86_64__)
  if (has_avx2()) return multiply_conjugate_avx2(a, b, count, out);
#endif
  multiply_conjugate_loop(a, b, count, out);
}

void add_four(const float* a, const float* b, const float* c, const float* d, std::size_t count, float* out) {
#if defined(__x86_64__)
  if (has_avx2()) return add_four_avx2(a, b, c, d, count, out);
#endif
  add_four_loop(a, b, c, d, count, out);
}

void add_to(const float* more, std::size_t count, float* values) {
#if defined(__x86_64__)
  if (has_avx2()) return add_to_avx2(more, count, values);
#endif
  add_to_loop(more, count, values);
}

void normalise(const float* window_sum, const float* inverse_norm, float mean, float scale, std::size_t count,
               float* values) {
#if defined(__x86_64__)
  if (has_avx2()) return normalise_avx2(window_sum, inverse_norm, mean, scale, count, values);
#endif
  normalise_loop(window_sum, inverse_norm, mean, scale, count, values);
}

SpanSums sum_span(const float* values, std::size_t count) {
#if defined(__x86_64__)
  if (has_avx2()) return sum_span_avx2(values, count);
#endif
  return sum_span_loop(values, count);
}

}  // namespace pilotage
