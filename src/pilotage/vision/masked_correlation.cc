#include "pilotage/vision/masked_correlation.h"

#include <algorithm>
#include <cmath>

#include <opencv2/core.hpp>

#include "pilotage/vision/mask_weight.h"
#include "pilotage/vision/picture_spectra.h"

namespace pilotage {
namespace {

constexpr double kFlatShare = 1e-5;

/// Pixels less their mean where valid, 0 elsewhere: the small sums lose less to rounding.
cv::Mat centred(const cv::Mat& pixels, const cv::Mat& valid) {
  cv::Mat shifted;
  pixels.convertTo(shifted, CV_32F, 1, -cv::mean(pixels, valid)[0]);
  shifted.setTo(0, valid == 0);
  return shifted;
}

}  // namespace

SumsOfProducts opencv_sums_of_products(const cv::Size& template_size, const cv::Size& region_size) {
  const PictureSpectra spectra(region_size);
  const cv::Size size(region_size.width - template_size.width + 1, region_size.height - template_size.height + 1);
  const auto spectrum = [spectra](const cv::Mat& pixels) { return spectra.spectrum(pixels); };
  const auto correlate = [size](const cv::Mat& template_spectrum, const cv::Mat& region_spectrum) {
    cv::Mat product = PictureSpectra::product(region_spectrum, template_spectrum);
    return PictureSpectra::pixels(product, cv::Rect({0, 0}, size));
  };
  return {spectrum, correlate};
}

MaskedCorrelation::MaskedCorrelation(const cv::Mat& mask, const cv::Mat& region, const cv::Mat& region_valid,
                                     double min_overlap, double flat_variance, const SumsOfProducts& sums)
    : sums_(sums),
      size_(region.cols - mask.cols + 1, region.rows - mask.rows + 1),
      mask_(mask_weight(mask)),
      needed_(std::max(2.0, min_overlap * cv::countNonZero(mask))),
      flat_variance_(flat_variance),
      whole_(cv::countNonZero(region_valid) == static_cast<int>(region_valid.total())) {
  const cv::Mat mask_spectrum = sums_.spectrum(mask_);
  const cv::Mat pixels = centred(region, region_valid);
  region_spectrum_ = sums_.spectrum(pixels);
  if (whole_) {
    counts_ = cv::Mat(size_, CV_32F, cv::Scalar(cv::countNonZero(mask)));
  } else {
    region_mask_spectrum_ = sums_.spectrum(mask_weight(region_valid));
    counts_ = sums_.correlate(mask_spectrum, region_mask_spectrum_);
    for (auto it = counts_.begin<float>(); it != counts_.end<float>(); ++it) *it = std::round(*it);
  }
  region_sums_ = sums_.correlate(mask_spectrum, region_spectrum_);
  region_scatter_ = scatter(region_sums_, sums_.correlate(mask_spectrum, sums_.spectrum(pixels.mul(pixels))));
}

/// Sum of squared differences from the mean, 0 where it is too small to tell from nothing.
cv::Mat MaskedCorrelation::scatter(const cv::Mat& sums, const cv::Mat& squares) const {
  cv::Mat result(size_, CV_32F);
  double largest = 0;
  for (int row = 0; row < size_.height; ++row) {
    const auto* n = counts_.ptr<float>(row);
    const auto* sum = sums.ptr<float>(row);
    const auto* square = squares.ptr<float>(row);
    auto* out = result.ptr<float>(row);
    for (int col = 0; col < size_.width; ++col) {
      const bool compared = static_cast<double>(n[col]) >= needed_;
      out[col] = compared ? square[col] - sum[col] * sum[col] / n[col] : 0.0F;
    }
  }
  cv::minMaxLoc(result, nullptr, &largest);
  const auto least = static_cast<float>(kFlatShare * largest);
  const auto flat_variance = static_cast<float>(flat_variance_);
  for (int row = 0; row < size_.height; ++row) {
    const auto* n = counts_.ptr<float>(row);
    auto* out = result.ptr<float>(row);
    for (int col = 0; col < size_.width; ++col) {
      if (out[col] <= least || out[col] <= flat_variance * n[col]) out[col] = 0;
    }
  }
  return result;
}

cv::Mat MaskedCorrelation::surface(const cv::Mat& pixels) const {
  const cv::Mat t = centred(pixels, mask_ != 0);
  const cv::Mat t_spectrum = sums_.spectrum(t);
  cv::Mat t_sums;
  cv::Mat t_scatter;
  if (whole_) {  // its sum is 0 and its squares are the same everywhere
    const cv::Mat squares(size_, CV_32F, cv::Scalar(cv::norm(t, cv::NORM_L2SQR)));
    t_sums = cv::Mat::zeros(size_, CV_32F);
    t_scatter = scatter(t_sums, squares);
  } else {
    t_sums = sums_.correlate(t_spectrum, region_mask_spectrum_);
    t_scatter = scatter(t_sums, sums_.correlate(sums_.spectrum(t.mul(t)), region_mask_spectrum_));
  }
  cv::Mat result = sums_.correlate(t_spectrum, region_spectrum_);
  for (int row = 0; row < size_.height; ++row) {
    const auto* n = counts_.ptr<float>(row);
    const auto* t_sum = t_sums.ptr<float>(row);
    const auto* g_sum = region_sums_.ptr<float>(row);
    const auto* tt = t_scatter.ptr<float>(row);
    const auto* gg = region_scatter_.ptr<float>(row);
    auto* out = result.ptr<float>(row);
    for (int col = 0; col < size_.width; ++col) {
      // Flat where a scatter is 0; the product of two floats may overflow, their roots not.
      const float norm = std::sqrt(tt[col]) * std::sqrt(gg[col]);
      const float product = out[col] - t_sum[col] * g_sum[col] / std::max(n[col], 1.0F);
      const float value = norm > 0 ? std::clamp(product / norm, -1.0F, 1.0F) : 0.0F;
      out[col] = static_cast<double>(n[col]) >= needed_ ? value : kNotCompared;
    }
  }
  return result;
}

}  // namespace pilotage
