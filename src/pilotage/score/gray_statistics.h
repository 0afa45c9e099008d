#pragma once

#include <cstdint>
#include <limits>
#include <variant>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace pilotage {

/// The gray values of a tile as two numbers and a readable third, over its N valid pixels with gray values f ≥ 0
/// (docs/methods/gray-statistics.md has the derivations and the error bounds).
struct GrayStatistics {
  std::int64_t count = 0;  ///< N: valid pixels.
  double mean = std::numeric_limits<double>::quiet_NaN();
  /// Eq. 1: V = sqrt(1/(N−1) · Σ (f − f̄)²), gray levels; NaN when N < 2. 0 exactly when all values are equal.
  double gray_variance = std::numeric_limits<double>::quiet_NaN();
  /// Eq. 2–3: H = Σ p·e^(1−p) with p = f / Σf; no unit. NaN when Σf = 0 or any f < 0, where p is no distribution.
  double frieden_entropy = std::numeric_limits<double>::quiet_NaN();
  /// N·(1 − H/e) − 1 ≈ (σ/f̄)², computed without the cancellation that this form has. NaN where H is.
  double frieden_deficit = std::numeric_limits<double>::quiet_NaN();
};

/// V, H and the deficit of all valid pixels of `gray` (CV_8U, CV_16U, CV_32F or CV_64F, one channel), by two passes
/// over the pixels; the oracle of PowerSums. `valid` is CV_8U of the same size (0 = no ground); pixels that are not
/// finite count as not valid. Relative error of V and H below 1e-12, of the deficit below 1e-12 of its largest term.
GrayStatistics gray_statistics(const cv::Mat& gray, const cv::Mat& valid);

/// Integral images of the power sums S_k = Σ f^k, k = 0 … 4, of a grid: the statistics of any window in constant time.
///
/// CV_8U: all sums are exact integers. CV_16U: S0 … S2 are exact; S3 and S4, which only enter correction terms of order
/// 1/N, are doubles. CV_32F and CV_64F: sums of powers cannot reach the bound (the variance is a difference of large
/// numbers), so a window is evaluated by gray_statistics, in time proportional to its area.
///
/// H is the series e·(1 − P2 + P3/2 − P4/6), P_k = S_k / S1^k. Its remainder is at most P5/24; a window where that is
/// not below 1e-13 of H and 1e-11 of the deficit (small windows, a few bright pixels on black) is summed exactly: from
/// a histogram of its pixels for CV_8U, pixel by pixel for CV_16U. Relative error of V and H below 1e-9 for every
/// window.
class PowerSums {
 public:
  /// Keeps a reference to both images. Throws UsageError on another type or sizes that differ.
  PowerSums(const cv::Mat& gray, const cv::Mat& valid);

  /// Statistics of a window that lies inside the image.
  GrayStatistics at(const cv::Rect& window) const;

 private:
  struct Exact8 {  // power sums of one integral-image corner, side by side in memory
    std::uint64_t count, s1, s2, s3, s4;
  };
  struct Exact16 {
    std::uint64_t count, s1, s2;
    double s3, s4;
  };
  template <class Sums>
  GrayStatistics at_sums(const std::vector<Sums>& sums, const cv::Rect& window) const;

  cv::Mat gray_;
  cv::Mat valid_;
  std::variant<std::monostate, std::vector<Exact8>, std::vector<Exact16>> sums_;
};

}  // namespace pilotage
