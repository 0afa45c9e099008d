#include "pilotage/score/gray_statistics.h"

#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

__extension__ using Wide = unsigned __int128;

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

template <class T, class Sums>
std::vector<Sums> integrate(const cv::Mat& gray, const cv::Mat& valid) {
  const auto pitch = static_cast<std::size_t>(gray.cols) + 1;
  std::vector<Sums> sums(pitch * (static_cast<std::size_t>(gray.rows) + 1));
  using Power = decltype(Sums::s3);
  for (int row = 0; row < gray.rows; ++row) {
    const T* values = gray.ptr<T>(row);
    const std::uint8_t* mask = valid.ptr(row);
    const Sums* above = sums.data() + static_cast<std::size_t>(row) * pitch + 1;
    Sums* here = sums.data() + static_cast<std::size_t>(row + 1) * pitch + 1;
    Sums line{};
    for (int col = 0; col < gray.cols; ++col) {
      if (mask[col] != 0) {
        const std::uint64_t f = values[col];
        const std::uint64_t f2 = f * f;
        line.count += 1;
        line.s1 += f;
        line.s2 += f2;
        line.s3 += static_cast<Power>(f2) * static_cast<Power>(f);
        line.s4 += static_cast<Power>(f2) * static_cast<Power>(f2);
      }
      here[col] = {above[col].count + line.count, above[col].s1 + line.s1, above[col].s2 + line.s2,
                   above[col].s3 + line.s3, above[col].s4 + line.s4};
    }
  }
  return sums;
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

PowerSums::PowerSums(const cv::Mat& gray, const cv::Mat& valid) : gray_(gray), valid_(valid) {
  check_images(gray, valid);
  if (gray.depth() == CV_8U) sums_ = integrate<std::uint8_t, Exact8>(gray, valid);
  if (gray.depth() == CV_16U) sums_ = integrate<std::uint16_t, Exact16>(gray, valid);
}

GrayStatistics PowerSums::at(const cv::Rect& window) const {
  if (const auto* sums = std::get_if<std::vector<Exact8>>(&sums_)) return at_sums(*sums, window);
  if (const auto* sums = std::get_if<std::vector<Exact16>>(&sums_)) return at_sums(*sums, window);
  return gray_statistics(gray_(window), valid_(window));
}

template <class Sums>
GrayStatistics PowerSums::at_sums(const std::vector<Sums>& sums, const cv::Rect& window) const {
  constexpr bool kByte = std::is_same_v<Sums, Exact8>;
  constexpr double kLargest = kByte ? 255 : 65535;
  const auto pitch = static_cast<std::size_t>(gray_.cols) + 1;
  const Sums* top = sums.data() + static_cast<std::size_t>(window.y) * pitch + static_cast<std::size_t>(window.x);
  const Sums* bottom = top + static_cast<std::size_t>(window.height) * pitch;
  const auto width = static_cast<std::size_t>(window.width);
  const auto over_window = [&](auto Sums::*power) {
    return bottom[width].*power - bottom[0].*power - (top[width].*power - top[0].*power);
  };
  const std::uint64_t n = over_window(&Sums::count);
  const std::uint64_t s1 = over_window(&Sums::s1);
  const double scatter_value = scatter(n, s1, over_window(&Sums::s2));
  GrayStatistics result = moments(n, s1, scatter_value);
  if (s1 == 0) return result;

  // N(1 − H/e) − 1 = (N·P2 − 1) − N·P3/2 + N·P4/6 − …, an alternating series whose rest is at most N·P5/24.
  const auto sum = static_cast<double>(s1);
  const double n_over_square = static_cast<double>(n) / (sum * sum);
  const double third = n_over_square * static_cast<double>(over_window(&Sums::s3)) / (2 * sum);
  const double fourth = n_over_square * static_cast<double>(over_window(&Sums::s4)) / (6 * sum * sum);
  const double deficit = scatter_value / (sum * sum) - third + fourth;
  const double rest = fourth / 4 * std::min(1.0, kLargest / sum);
  const double ratio = 1 - (1 + deficit) / static_cast<double>(n);  // H/e
  if (rest > 1e-11 * std::abs(deficit) || rest > 1e-13 * ratio * static_cast<double>(n)) {
    if constexpr (kByte) return from_histogram(gray_(window), valid_(window));
    return gray_statistics(gray_(window), valid_(window));
  }
  result.frieden_deficit = deficit;
  result.frieden_entropy = std::numbers::e * ratio;
  return result;
}

}  // namespace pilotage
