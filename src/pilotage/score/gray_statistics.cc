#include "pilotage/score/gray_statistics.h"

#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>

#include <opencv2/core/hal/intrin.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/parallel.h"

namespace pilotage {
namespace {

__extension__ using Wide = unsigned __int128;
constexpr std::size_t kRowsAtOnce = 8;       // rows of cells that are one piece of work
constexpr std::size_t kColumnsAtOnce = 128;  // columns of windows that are one piece of work

void check_images(const cv::Mat& gray, const cv::Mat& valid) {
  const int depth = gray.depth();
  if (gray.channels() != 1 || (depth != CV_8U && depth != CV_16U && depth != CV_32F && depth != CV_64F)) {
    throw UsageError("gray statistics need one channel of 8-bit, 16-bit or floating-point pixels");
  }
  if (valid.type() != CV_8UC1 || valid.size() != gray.size()) {
    throw UsageError("gray statistics: the mask of valid pixels must be CV_8U and as large as the image");
  }
}

/// φ(p) = 1 − (1 − e^(−p))/p = p/2 − p²/6 + p³/24 − …, to double precision for p in [0, 1].
double phi(double p) {
  if (p > 0.05) return 1 + std::expm1(-p) / p;
  // Horner's scheme of Σ (−1)^(k+1) p^k / (k+1)!, truncated where p^8/9! < 1e-16·p/2.
  return p / 2 * (1 - p / 3 * (1 - p / 4 * (1 - p / 5 * (1 - p / 6 * (1 - p / 7 * (1 - p / 8))))));
}

/// Calls f(value) for every valid finite pixel.
template <class T, class Function>
void for_each_valid(const cv::Mat& gray, const cv::Mat& valid, Function&& function) {
  for (int row = 0; row < gray.rows; ++row) {
    const T* values = gray.ptr<T>(row);
    const std::uint8_t* mask = valid.ptr(row);
    for (int col = 0; col < gray.cols; ++col) {
      if (mask[col] == 0) continue;
      if constexpr (std::is_floating_point_v<T>) {
        if (!std::isfinite(values[col])) continue;
      }
      function(values[col]);
    }
  }
}

/// 80-bit sums: 11 bits more than the result needs, and no overflow for any double.
template <class T>
GrayStatistics direct(const cv::Mat& gray, const cv::Mat& valid) {
  GrayStatistics result;
  long double sum = 0;
  long double low = std::numeric_limits<long double>::infinity();
  long double high = -low;
  for_each_valid<T>(gray, valid, [&](T value) {
    ++result.count;
    const long double f = value;
    sum += f;
    low = std::min(low, f);
    high = std::max(high, f);
  });
  if (result.count == 0) return result;
  const auto n = static_cast<long double>(result.count);
  const long double mean = low == high ? low : sum / n;
  result.mean = static_cast<double>(mean);

  // Σ (f − f̄)², corrected for the rounding of f̄ (T. Chan, G. Golub, R. LeVeque, The American Statistician 37(3), 1983,
  // eq. 1.7).
  long double squares = 0;
  long double rest = 0;
  for_each_valid<T>(gray, valid, [&](T value) {
    const long double d = static_cast<long double>(value) - mean;
    squares += d * d;
    rest += d;
  });
  squares = std::max(0.0L, squares - rest * rest / n);
  if (result.count > 1) result.gray_variance = static_cast<double>(std::sqrt(squares / (n - 1)));
  if (low < 0 || !(sum > 0)) return result;

  long double entropy = 0;
  long double beyond_squares = 0;  // Σ p²·φ(p)
  for_each_valid<T>(gray, valid, [&](T value) {
    const auto p = static_cast<double>(static_cast<long double>(value) / sum);
    entropy += static_cast<long double>(p * std::exp(1 - p));
    beyond_squares += static_cast<long double>(p * p * phi(p));
  });
  result.frieden_entropy = static_cast<double>(entropy);
  // N(1 − H/e) − 1 with 1 − H/e = Σ p(1 − e^(−p)) = Σ p²(1 − φ(p)), and N·Σp² − 1 = N·Σ(f − f̄)²/S1².
  result.frieden_deficit = static_cast<double>(n * squares / sum / sum - n * beyond_squares);
  return result;
}

/// (N·S2 − S1²) without rounding.
double scatter(std::uint64_t n, std::uint64_t s1, std::uint64_t s2) {
  return static_cast<double>(Wide{n} * s2 - Wide{s1} * s1);
}

GrayStatistics moments(std::uint64_t n, std::uint64_t s1, double scatter_value) {
  GrayStatistics result;
  result.count = static_cast<std::int64_t>(n);
  if (n == 0) return result;
  const auto count = static_cast<double>(n);
  result.mean = static_cast<double>(s1) / count;
  if (n > 1) result.gray_variance = std::sqrt(scatter_value / (count * (count - 1)));
  return result;
}

/// 8-bit windows are summed over gray levels instead of pixels: at most 255 exponentials.
GrayStatistics from_histogram(const cv::Mat& gray, const cv::Mat& valid) {
  std::array<std::uint64_t, 256> histogram{};
  for_each_valid<std::uint8_t>(gray, valid, [&](std::uint8_t value) { ++histogram[value]; });
  std::uint64_t n = 0;
  std::uint64_t s1 = 0;
  std::uint64_t s2 = 0;
  for (std::uint64_t f = 0; f < 256; ++f) {
    n += histogram[f];
    s1 += histogram[f] * f;
    s2 += histogram[f] * f * f;
  }
  const double scatter_value = scatter(n, s1, s2);
  GrayStatistics result = moments(n, s1, scatter_value);
  if (s1 == 0) return result;
  const auto sum = static_cast<double>(s1);
  double entropy = 0;
  double beyond_squares = 0;
  for (std::size_t f = 1; f < 256; ++f) {
    if (histogram[f] == 0) continue;
    const double p = static_cast<double>(f) / sum;
    const auto times = static_cast<double>(histogram[f]);
    entropy += times * p * std::exp(1 - p);
    beyond_squares += times * p * p * phi(p);
  }
  result.frieden_entropy = entropy;
  result.frieden_deficit = scatter_value / (sum * sum) - static_cast<double>(n) * beyond_squares;
  return result;
}

/// Adds the valid pixels of a rectangle to power sums.
template <class T, class Sums>
void add_pixels(const cv::Mat& gray, const cv::Mat& valid, const cv::Rect& place, Sums& sums) {
  using Power = decltype(Sums::s4);
  for (int row = place.y; row < place.y + place.height; ++row) {
    const T* values = gray.ptr<T>(row) + place.x;
    const std::uint8_t* mask = valid.ptr(row) + place.x;
    for (int col = 0; col < place.width; ++col) {
      const std::uint64_t f = mask[col] != 0 ? values[col] : 0;
      const std::uint64_t f2 = f * f;
      sums.count += mask[col] != 0 ? 1 : 0;
      sums.s1 += f;
      sums.s2 += f2;
      sums.s3 += f2 * f;
      sums.s4 += static_cast<Power>(f2 * f2);
    }
  }
}

std::uint64_t wide_sum(const cv::v_int32x4& lanes) {
  cv::v_int64x2 low;
  cv::v_int64x2 high;
  cv::v_expand(lanes, low, high);
  return static_cast<std::uint64_t>(cv::v_reduce_sum(low + high));
}

/// The same of 8-bit pixels, eight at a time: sums of d = f − 128 by products of 16-bit numbers. |d|³ ≤ 2^21, so 32
/// bits hold the sums of 512 times eight pixels; d⁴ is added up in 64 bits.
template <class Sums>
void add_bytes(const cv::Mat& gray, const cv::Mat& valid, const cv::Rect& place, Sums& sums) {
  constexpr int kLanes = 8;
  constexpr int kMostAdds = 512;
  const int vectors = place.width / kLanes;
  if (vectors == 0 || vectors > kMostAdds) return add_pixels<std::uint8_t>(gray, valid, place, sums);
  const cv::v_int16x8 middle = cv::v_setall_s16(128);
  const cv::v_int16x8 one = cv::v_setall_s16(1);
  const int rows_at_once = kMostAdds / vectors;
  for (int first = place.y; first < place.y + place.height; first += rows_at_once) {
    cv::v_int32x4 n = cv::v_setzero_s32();
    cv::v_int32x4 d1 = n;
    cv::v_int32x4 d2 = n;
    cv::v_int32x4 d3 = n;
    cv::v_uint64x2 d4 = cv::v_setzero_u64();
    for (int row = first; row < std::min(first + rows_at_once, place.y + place.height); ++row) {
      const std::uint8_t* values = gray.ptr(row) + place.x;
      const std::uint8_t* mask = valid.ptr(row) + place.x;
      for (int i = 0; i < vectors * kLanes; i += kLanes) {
        const cv::v_int16x8 keep = cv::v_reinterpret_as_s16(cv::v_load_expand(mask + i)) != cv::v_setzero_s16();
        const cv::v_int16x8 d = (cv::v_reinterpret_as_s16(cv::v_load_expand(values + i)) - middle) & keep;
        const cv::v_int16x8 square = cv::v_mul_wrap(d, d);
        cv::v_uint64x2 low;
        cv::v_uint64x2 high;
        cv::v_expand(cv::v_reinterpret_as_u32(cv::v_dotprod(square, square)), low, high);
        n -= cv::v_dotprod(keep, one);
        d1 += cv::v_dotprod(d, one);
        d2 += cv::v_dotprod(d, d);
        d3 += cv::v_dotprod(square, d);
        d4 = d4 + low + high;
      }
    }
    // Powers of f = d + 128, modulo 2^64.
    const auto count = static_cast<std::uint64_t>(cv::v_reduce_sum(n));
    const auto sum1 = static_cast<std::uint64_t>(std::int64_t{cv::v_reduce_sum(d1)});
    const auto sum2 = static_cast<std::uint64_t>(cv::v_reduce_sum(d2));
    const auto sum3 = wide_sum(d3);
    const auto sum4 = static_cast<std::uint64_t>(cv::v_reduce_sum(d4));
    sums.count += count;
    sums.s1 += sum1 + 128 * count;
    sums.s2 += sum2 + 256 * sum1 + (count << 14);
    sums.s3 += sum3 + 384 * sum2 + 49152 * sum1 + (count << 21);
    sums.s4 += sum4 + 512 * sum3 + 98304 * sum2 + 8388608 * sum1 + (count << 28);
  }
  const int rest = place.width - vectors * kLanes;
  if (rest > 0) {
    add_pixels<std::uint8_t>(gray, valid, {place.x + vectors * kLanes, place.y, rest, place.height}, sums);
  }
}

template <class Sums>
void add(Sums& sums, const Sums& others) {
  sums.count += others.count;
  sums.s1 += others.s1;
  sums.s2 += others.s2;
  sums.s3 += others.s3;
  sums.s4 += others.s4;
}

template <class Sums>
Sums difference(const Sums& a, const Sums& b) {
  return {a.count - b.count, a.s1 - b.s1, a.s2 - b.s2, a.s3 - b.s3, a.s4 - b.s4};
}

double to_double(std::uint64_t value) {
  return static_cast<double>(value);
}

/// To one part in 2^52, several times faster than the compiler's conversion.
double to_double(Wide value) {
  return static_cast<double>(static_cast<std::uint64_t>(value >> 64)) * 0x1p64 +
         static_cast<double>(static_cast<std::uint64_t>(value));
}

}  // namespace

GrayStatistics gray_statistics(const cv::Mat& gray, const cv::Mat& valid) {
  check_images(gray, valid);
  switch (gray.depth()) {
    case CV_8U:
      return direct<std::uint8_t>(gray, valid);
    case CV_16U:
      return direct<std::uint16_t>(gray, valid);
    case CV_32F:
      return direct<float>(gray, valid);
    default:
      return direct<double>(gray, valid);
  }
}

WindowSums::WindowSums(const cv::Mat& gray, const cv::Mat& valid, int side_px, int stride_px, int threads)
    : gray_(gray), valid_(valid), side_px_(side_px), stride_px_(stride_px) {
  constexpr int kLargestSide = 65535;  // S3 of as many 8-bit pixels is below 2^64
  check_images(gray, valid);
  if (side_px < 1 || side_px > kLargestSide || stride_px < 1) {
    throw UsageError("windows of " + std::to_string(side_px) + " px every " + std::to_string(stride_px) +
                     " px: sides are 1 to " + std::to_string(kLargestSide) + " px, strides at least 1 px");
  }
  cell_px_ = std::gcd(side_px, stride_px);
  if (gray.cols < side_px || gray.rows < side_px) return;
  columns_ = (gray.cols - side_px) / stride_px + 1;
  rows_ = (gray.rows - side_px) / stride_px + 1;
  if (gray.depth() == CV_8U) add_up<std::uint8_t>(sums_.emplace<std::vector<Sums8>>(), threads);
  if (gray.depth() == CV_16U) add_up<std::uint16_t>(sums_.emplace<std::vector<Sums16>>(), threads);
}

cv::Rect WindowSums::window(std::int64_t column, std::int64_t row) const {
  return {static_cast<int>(column * stride_px_), static_cast<int>(row * stride_px_), side_px_, side_px_};
}

GrayStatistics WindowSums::at(std::int64_t column, std::int64_t row) const {
  if (const auto* sums = std::get_if<std::vector<Sums8>>(&sums_)) return at_sums(*sums, column, row);
  if (const auto* sums = std::get_if<std::vector<Sums16>>(&sums_)) return at_sums(*sums, column, row);
  return gray_statistics(gray_(window(column, row)), valid_(window(column, row)));
}

/// Line r + 1 of `sums` gets what row r of cells adds to each column of windows; then lines are added up downwards.
template <class T, class Power>
void WindowSums::add_up(std::vector<Sums<Power>>& sums, int threads) const {
  const auto columns = static_cast<std::size_t>(columns_);
  const auto cells_down = static_cast<std::size_t>(((rows_ - 1) * stride_px_ + side_px_) / cell_px_);
  const auto cells_across = static_cast<std::size_t>(((columns_ - 1) * stride_px_ + side_px_) / cell_px_);
  const auto cells_of_window = static_cast<std::size_t>(side_px_ / cell_px_);
  const auto cells_of_stride = static_cast<std::size_t>(stride_px_ / cell_px_);
  sums.resize((cells_down + 1) * columns);
  parallel_for((cells_down + kRowsAtOnce - 1) / kRowsAtOnce, threads, [&](std::size_t piece, int) {
    std::vector<Sums<Power>> line(cells_across + 1);  // from the left edge to each cell
    const std::size_t end = std::min(cells_down, (piece + 1) * kRowsAtOnce);
    for (std::size_t row = piece * kRowsAtOnce; row < end; ++row) {
      for (std::size_t cell = 0; cell < cells_across; ++cell) {
        const cv::Rect place(static_cast<int>(cell) * cell_px_, static_cast<int>(row) * cell_px_, cell_px_, cell_px_);
        line[cell + 1] = line[cell];
        if constexpr (std::is_same_v<T, std::uint8_t>) {
          add_bytes(gray_, valid_, place, line[cell + 1]);
        } else {
          add_pixels<T>(gray_, valid_, place, line[cell + 1]);
        }
      }
      Sums<Power>* below = sums.data() + (row + 1) * columns;
      for (std::size_t column = 0; column < columns; ++column) {
        const std::size_t first = column * cells_of_stride;
        below[column] = difference(line[first + cells_of_window], line[first]);
      }
    }
  });
  parallel_for((columns + kColumnsAtOnce - 1) / kColumnsAtOnce, threads, [&](std::size_t piece, int) {
    const std::size_t end = std::min(columns, (piece + 1) * kColumnsAtOnce);
    for (std::size_t row = 1; row <= cells_down; ++row) {
      const Sums<Power>* above = sums.data() + (row - 1) * columns;
      Sums<Power>* here = sums.data() + row * columns;
      for (std::size_t column = piece * kColumnsAtOnce; column < end; ++column) add(here[column], above[column]);
    }
  });
}

template <class Power>
GrayStatistics WindowSums::at_sums(const std::vector<Sums<Power>>& sums, std::int64_t column, std::int64_t row) const {
  constexpr bool kByte = std::is_same_v<Power, std::uint64_t>;
  constexpr double kLargest = kByte ? 255 : 65535;
  const Sums<Power>* top = sums.data() + row * (stride_px_ / cell_px_) * columns_ + column;
  const Sums<Power> in = difference(top[side_px_ / cell_px_ * columns_], top[0]);
  const double scatter_value = scatter(in.count, in.s1, in.s2);
  GrayStatistics result = moments(in.count, in.s1, scatter_value);
  if (in.s1 == 0) return result;

  // N(1 − H/e) − 1 = (N·P2 − 1) − N·P3/2 + N·P4/6 − …, an alternating series whose rest is at most N·P5/24.
  const auto n = static_cast<double>(in.count);
  const double inverse = 1 / static_cast<double>(in.s1);
  const double inverse_square = inverse * inverse;
  const double third = n * inverse_square * inverse * to_double(in.s3) / 2;
  const double fourth = n * inverse_square * inverse_square * to_double(in.s4) / 6;
  const double deficit = scatter_value * inverse_square - third + fourth;
  const double rest = fourth / 4 * std::min(1.0, kLargest * inverse);
  const double beyond_entropy = 1 + deficit;  // N·(1 − H/e)
  if (rest > 1e-11 * std::abs(deficit) || rest > 1e-13 * (n - beyond_entropy)) {
    const cv::Rect place = window(column, row);
    if constexpr (kByte) return from_histogram(gray_(place), valid_(place));
    return gray_statistics(gray_(place), valid_(place));
  }
  result.frieden_deficit = deficit;
  result.frieden_entropy = std::numbers::e * (1 - beyond_entropy / n);
  return result;
}

}  // namespace pilotage
