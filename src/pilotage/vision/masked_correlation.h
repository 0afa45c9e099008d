#pragma once

#include <functional>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace pilotage {

/// Where sums of products come from: some library's transforms. Serves one thread at a time.
struct SumsOfProducts {
  /// Whatever of CV_32FC1 pixels, at most as large as the region, `correlate` needs.
  std::function<cv::Mat(const cv::Mat& pixels)> spectrum;
  /// Σ template·region at every position where the template lies inside the region, CV_32FC1.
  std::function<cv::Mat(const cv::Mat& template_spectrum, const cv::Mat& region_spectrum)> correlate;
};

/// By OpenCV, of templates of `template_size` and a region.
SumsOfProducts opencv_sums_of_products(const cv::Size& template_size, const cv::Size& region_size);

/// Zero-mean normalised cross-correlation of templates with one region, over the pixels valid in both: D. Padfield,
/// "Masked object registration in the Fourier domain", IEEE Trans. Image Processing 21(5), 2012, eq. 9. Pixels are
/// numbers or vectors (channels): products are then inner ones, and each channel has its own mean; of two channels that
/// is the real part of the correlation of complex numbers. A class because its spectra serve every template: all share
/// one mask, so that half of eq. 9's sums are computed once, and where the region has no hole all but one.
class MaskedCorrelation {
 public:
  /// `mask` and `region_valid` are CV_8UC1 (0 = not valid), `region` CV_8U or CV_32F of the size of region_valid, which
  /// is at least as large as the mask. A variance below `flat_variance` (of pixel values) counts as none.
  MaskedCorrelation(const cv::Mat& mask, const cv::Mat& region, const cv::Mat& region_valid, double min_overlap,
                    double flat_variance, const SumsOfProducts& sums);

  /// The surface of one template (CV_32F of the mask's size and the region's channels; what stands outside the mask
  /// does not matter): CV_32FC1 of (region − mask + 1), −1 … 1. kNotCompared where fewer than min_overlap of the mask's
  /// pixels are valid; 0 where template or region is flat over the overlap: its variance below flat_variance or below
  /// 1e-5 of the largest. Error below 1e-3 where the region's variance is at least 1/100 of the largest.
  cv::Mat surface(const cv::Mat& pixels) const;

  /// Number of pixels compared at each position, CV_32FC1.
  const cv::Mat& counts() const { return counts_; }

  static constexpr float kNotCompared = -2;

 private:
  cv::Mat scatter(const std::vector<cv::Mat>& sums, const cv::Mat& squares) const;
  cv::Mat normalised(const cv::Mat& products, const cv::Mat& t_scatter) const;

  SumsOfProducts sums_;
  cv::Size size_;  // of the surface
  cv::Mat mask_;   // CV_32F, 0 or 1
  double needed_ = 0;
  double flat_variance_ = 0;
  bool whole_ = false;  // every pixel of the region is valid
  cv::Mat region_mask_spectrum_;
  std::vector<cv::Mat> region_spectra_;  // of each channel
  cv::Mat counts_;
  std::vector<cv::Mat> region_sums_;  // of each channel
  cv::Mat region_scatter_;            // n times the variance over the overlap; 0 = flat
};

}  // namespace pilotage
