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
/// over the pixels; the oracle of WindowSums. `valid` is CV_8U of the same size (0 = no ground); pixels that are not
/// finite count as not valid. Relative error of V and H below 1e-12, of the deficit below 1e-12 of its largest term.
GrayStatistics gray_statistics(const cv::Mat& gray, const cv::Mat& valid);

/// The statistics of all windows of one side at multiples of one stride, each in constant time, from the power sums
/// S_k = Σ f^k, k = 0 … 4, of cells: squares of gcd(side, stride) pixels. For every row of cells the sums of `side`
/// pixels across stand at each place of a window, added up from the top; a window is the difference of two of them.
///
/// CV_8U and CV_16U: all sums are exact integers, so a window's numbers depend on its pixels alone. CV_32F and CV_64F:
/// sums of powers cannot reach the bound (the variance is a difference of large numbers), so a window is evaluated by
/// gray_statistics, in time proportional to its area.
///
/// H is the series e·(1 − P2 + P3/2 − P4/6), P_k = S_k / S1^k. Its remainder is at most P5/24; a window where that is
/// not below 1e-13 of H and 1e-11 of the deficit (small windows, a few bright pixels on black) is summed exactly: from
/// a histogram of its pixels for CV_8U, pixel by pixel for CV_16U. Relative error of V and H below 1e-9 for every
/// window.
class WindowSums {
 public:
  /// Windows whose first pixel lies at multiples of `stride_px` and which lie inside the image; maybe there is none.
  /// Keeps a reference to both images. The same for any number of threads. Throws UsageError for another type, sizes
  /// that differ, or a side outside [1, 65535] or stride below 1.
  WindowSums(const cv::Mat& gray, const cv::Mat& valid, int side_px, int stride_px, int threads = 1);

  std::int64_t columns() const { return columns_; }
  std::int64_t rows() const { return rows_; }

  /// Statistics of the window whose first pixel is (column · stride, row · stride).
  GrayStatistics at(std::int64_t column, std::int64_t row) const;

 private:
  __extension__ using Wide = unsigned __int128;
  template <class Power>
  struct Sums {  // of one window's width, side by side in memory; sums of more than a window may wrap around
    std::uint64_t count, s1, s2;
    Power s3, s4;
  };
  using Sums8 = Sums<std::uint64_t>;
  using Sums16 = Sums<Wide>;
  template <class T, class Power>
  void add_up(std::vector<Sums<Power>>& sums, int threads) const;
  template <class Power>
  GrayStatistics at_sums(const std::vector<Sums<Power>>& sums, std::int64_t column, std::int64_t row) const;
  cv::Rect window(std::int64_t column, std::int64_t row) const;

  cv::Mat gray_;
  cv::Mat valid_;
  int side_px_;
  int stride_px_;
  int cell_px_;
  std::int64_t columns_ = 0;
  std::int64_t rows_ = 0;
  std::variant<std::monostate, std::vector<Sums8>, std::vector<Sums16>> sums_;
};

}  // namespace pilotage
