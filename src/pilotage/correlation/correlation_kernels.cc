#include "pilotage/correlation/correlation_kernels.h"

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

[[gnu::always_inline]] inline void conjugate_product(const float* a, const float* b, Float8& product) {
  const Float8 sign = {1, -1, 1, -1, 1, -1, 1, -1};
  Float8 x;
  Float8 y;
  load(a, x);
  load(b, y);
  const Float8 real = __builtin_shufflevector(x, x, 0, 0, 2, 2, 4, 4, 6, 6);
  const Float8 imaginary = __builtin_shufflevector(x, x, 1, 1, 3, 3, 5, 5, 7, 7);
  const Float8 swapped = __builtin_shufflevector(y, y, 1, 0, 3, 2, 5, 4, 7, 6);
  product = real * y + sign * (imaginary * swapped);
}

[[gnu::always_inline]] inline void multiply_conjugate_sum_loop(const float* a, const float* b, std::size_t terms,
                                                               std::size_t count, float* out) {
  // Pairs of terms, so that `out` is not read and written for each.
  for (std::size_t term = 0; term < terms; term += 2) {
    const std::size_t next = term + 1 < terms ? 2 * count : 0;
    for (std::size_t i = 0; i < 2 * count; i += 8) {
      Float8 sum;
      conjugate_product(a + i, b + i, sum);
      Float8 more;
      if (next > 0) {
        conjugate_product(a + next + i, b + next + i, more);
        sum += more;
      }
      if (term > 0) {
        load(out + i, more);
        sum += more;
      }
      store(sum, out + i);
    }
    a += 2 * next;
    b += 2 * next;
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

/// to = from[0], from[step] … from[7·step]; reads nothing beyond.
template <std::size_t step>
[[gnu::always_inline]] inline void load_apart(const float* from, Float8& to) {
  Float8 a;
  Float8 b;
  load(from, a);
  if constexpr (step == 1) {
    to = a;
  } else if constexpr (step == 2) {
    load(from + 7, b);
    to = __builtin_shufflevector(a, b, 0, 2, 4, 6, 9, 11, 13, 15);
  } else {
    static_assert(step == 4);
    Float8 c;
    Float8 d;
    load(from + 8, b);
    load(from + 16, c);
    load(from + 21, d);
    const Float8 first = __builtin_shufflevector(a, b, 0, 4, 8, 12, 0, 4, 8, 12);
    const Float8 last = __builtin_shufflevector(c, d, 0, 4, 11, 15, 0, 4, 11, 15);
    to = __builtin_shufflevector(first, last, 0, 1, 2, 3, 8, 9, 10, 11);
  }
}

template <std::size_t step>
[[gnu::always_inline]] inline void normalise_loop(const float* window_sum, const float* inverse_norm, float mean,
                                                  float scale, std::size_t count, float* values) {
  const Float8 one = {1, 1, 1, 1, 1, 1, 1, 1};
  std::size_t i = 0;
  for (; i + 8 <= count; i += 8) {
    Float8 value;
    Float8 sum;
    Float8 norm;
    load(values + i, value);
    load_apart<step>(window_sum + step * i, sum);
    load_apart<step>(inverse_norm + step * i, norm);
    value = (value - mean * sum) * (scale * norm);
    value = value > one ? one : value;
    value = value < -one ? -one : value;
    store(value, values + i);
  }
  for (; i < count; ++i) {
    float value = (values[i] - mean * window_sum[step * i]) * (scale * inverse_norm[step * i]);
    value = value > 1 ? 1 : value;
    values[i] = value < -1 ? -1 : value;
  }
}

[[gnu::always_inline]] inline double sum_of_lanes(const Float8& lanes) {
  double sum = 0;
  for (int lane = 0; lane < 8; ++lane) sum += static_cast<double>(lanes[lane]);
  return sum;
}

[[gnu::always_inline]] inline void add_products_3x3_loop(const float* tile, const float* const map[3],
                                                         std::size_t count, double sums[9]) {
  Float8 lanes[9] = {};
  std::size_t i = 0;
  for (; i + 8 <= count; i += 8) {
    Float8 own;
    load(tile + i, own);
    for (std::size_t k = 0; k < 9; ++k) {
      Float8 other;
      load(map[k / 3] + i + k % 3, other);
      lanes[k] += own * other;
    }
  }
  for (std::size_t k = 0; k < 9; ++k) {
    double sum = sum_of_lanes(lanes[k]);
    for (std::size_t rest = i; rest < count; ++rest) {
      sum += static_cast<double>(tile[rest]) * static_cast<double>(map[k / 3][rest + k % 3]);
    }
    sums[k] += sum;
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
[[gnu::target("avx2")]] void multiply_conjugate_sum_avx2(const float* a, const float* b, std::size_t terms,
                                                         std::size_t count, float* out) {
  multiply_conjugate_sum_loop(a, b, terms, count, out);
}
[[gnu::target("avx2")]] void add_four_avx2(const float* a, const float* b, const float* c, const float* d,
                                           std::size_t count, float* out) {
  add_four_loop(a, b, c, d, count, out);
}
[[gnu::target("avx2")]] void add_to_avx2(const float* more, std::size_t count, float* values) {
  add_to_loop(more, count, values);
}
template <std::size_t step>
[[gnu::target("avx2")]] void normalise_avx2(const float* window_sum, const float* inverse_norm, float mean, float scale,
                                            std::size_t count, float* values) {
  normalise_loop<step>(window_sum, inverse_norm, mean, scale, count, values);
}
[[gnu::target("avx2")]] void add_products_3x3_avx2(const float* tile, const float* const map[3], std::size_t count,
                                                   double sums[9]) {
  add_products_3x3_loop(tile, map, count, sums);
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

void multiply_conjugate_sum(const float* a, const float* b, std::size_t terms, std::size_t count, float* out) {
#if defined(__x86_64__)
  if (has_avx2()) return multiply_conjugate_sum_avx2(a, b, terms, count, out);
#endif
  multiply_conjugate_sum_loop(a, b, terms, count, out);
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

void normalise(const float* window_sum, const float* inverse_norm, std::size_t step, float mean, float scale,
               std::size_t count, float* values) {
#if defined(__x86_64__)
  if (has_avx2()) {
    if (step == 1) return normalise_avx2<1>(window_sum, inverse_norm, mean, scale, count, values);
    if (step == 2) return normalise_avx2<2>(window_sum, inverse_norm, mean, scale, count, values);
    return normalise_avx2<4>(window_sum, inverse_norm, mean, scale, count, values);
  }
#endif
  if (step == 1) return normalise_loop<1>(window_sum, inverse_norm, mean, scale, count, values);
  if (step == 2) return normalise_loop<2>(window_sum, inverse_norm, mean, scale, count, values);
  normalise_loop<4>(window_sum, inverse_norm, mean, scale, count, values);
}

void add_products_3x3(const float* tile, const float* const map[3], std::size_t count, double sums[9]) {
#if defined(__x86_64__)
  if (has_avx2()) return add_products_3x3_avx2(tile, map, count, sums);
#endif
  add_products_3x3_loop(tile, map, count, sums);
}

SpanSums sum_span(const float* values, std::size_t count) {
#if defined(__x86_64__)
  if (has_avx2()) return sum_span_avx2(values, count);
#endif
  return sum_span_loop(values, count);
}

}  // namespace pilotage
