#include "pilotage/vision/masked_correlation.h"

#include <algorithm>
#include <cmath>

#include <opencv2/core.hpp>

namespace pilotage {
namespace {

constexpr double kFlatShare = 1e-5;

cv::Mat zero_or_one(const cv::Mat& valid) {
  cv::Mat result;
  cv::Mat(valid != 0).convertTo(result, CV_32F, 1.0 / 255);
  return result;
}

/// Each channel less its mean where valid, 0 elsewhere: the small sums lose less to rounding.
std::vector<cv::Mat> centred(const cv::Mat& pixels, const cv::Mat& valid) {
  std::vector<cv::Mat> channels;
  cv::split(pixels, channels);
  const cv::Mat holes = valid == 0;
  for (cv::Mat& channel : channels) {
    channel.convertTo(channel, CV_32F, 1, -cv::mean(channel, valid)[0]);
    channel.setTo(0, holes);
  }
  return channels;
}

/// Of all channels together.
cv::Mat squares_of(const std::vector<cv::Mat>& channels) {
  cv::Mat squares = channels.front().mul(channels.front());
  for (std::size_t i = 1; i < channels.size(); ++i) squares += channels[i].mul(channels[i]);
  return squares;
}

}  // namespace

SumsOfProducts opencv_sums_of_products(const cv::Size& template_size, const cv::Size& region_size) {
  const cv::Size fft_size(cv::getOptimalDFTSize(region_size.width), cv::getOptimalDFTSize(region_size.height));
  const cv::Size size(region_size.width - template_size.width + 1, region_size.height - template_size.height + 1);
  const auto spectrum = [fft_size](const cv::Mat& pixels) {
    cv::Mat padded = cv::Mat::zeros(fft_size, CV_32F);
    pixels.copyTo(padded(cv::Rect({0, 0}, pixels.size())));
    cv::dft(padded, padded, 0, pixels.rows);
    return padded;
  };
  const auto correlate = [size](const cv::Mat& template_spectrum, const cv::Mat& region_spectrum) {
    cv::Mat product;
    cv::mulSpectrums(region_spectrum, template_spectrum, product, 0, true);
    cv::dft(product, product, cv::DFT_INVERSE | cv::DFT_SCALE | cv::DFT_REAL_OUTPUT, size.height);
    return product(cv::Rect({0, 0}, size));
  };
  return {spectrum, correlate};
}

MaskedCorrelation::MaskedCorrelation(const cv::Mat& mask, const cv::Mat& region, const cv::Mat& region_valid,
                                     double min_overlap, double flat_variance, const SumsOfProducts& sums)
    : sums_(sums),
      size_(region.cols - mask.cols + 1, region.rows - mask.rows + 1),
      mask_(zero_or_one(mask)),
      needed_(std::max(2.0, min_overlap * cv::countNonZero(mask))),
      flat_variance_(flat_variance),
      whole_(cv::countNonZero(region_valid) == static_cast<int>(region_valid.total())) {
  const cv::Mat mask_spectrum = sums_.spectrum(mask_);
  const std::vector<cv::Mat> channels = centred(region, region_valid);
  for (const cv::Mat& channel : channels) {
    region_spectra_.push_back(sums_.spectrum(channel));
    region_sums_.push_back(sums_.correlate(mask_spectrum, region_spectra_.back()));
  }
  if (whole_) {
    counts_ = cv::Mat(size_, CV_32F, cv::Scalar(cv::countNonZero(mask)));
  } else {
    region_mask_spectrum_ = sums_.spectrum(zero_or_one(region_valid));
    counts_ = sums_.correlate(mask_spectrum, region_mask_spectrum_);
    for (auto it = counts_.begin<float>(); it != counts_.end<float>(); ++it) *it = std::round(*it);
  }
  region_scatter_ = scatter(region_sums_, sums_.correlate(mask_spectrum, sums_.spectrum(squares_of(channels))));
}

/// Sum of squared differences from the mean, 0 where it is too small to tell from nothing. Takes no sums as sums of 0.
cv::Mat MaskedCorrelation::scatter(const std::vector<cv::Mat>& sums, const cv::Mat& squares) const {
  cv::Mat result(size_, CV_32F);
  double largest = 0;
  for (int row = 0; row < size_.height; ++row) {
    const auto* n = counts_.ptr<float>(row);
    const auto* square = squares.ptr<float>(row);
    auto* out = result.ptr<float>(row);
    std::copy(square, square + size_.width, out);
    for (const cv::Mat& of_channel : sums) {
      const auto* sum = of_channel.ptr<float>(row);
      for (int col = 0; col < size_.width; ++col) out[col] -= sum[col] * sum[col] / std::max(n[col], 1.0F);
    }
    for (int col = 0; col < size_.width; ++col) {
      if (static_cast<double>(n[col]) < needed_) out[col] = 0;
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
  const std::vector<cv::Mat> channels = centred(pixels, mask_ != 0);
  cv::Mat products = cv::Mat::zeros(size_, CV_32F);
  std::vector<cv::Mat> t_sums;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const cv::Mat spectrum = sums_.spectrum(channels[i]);
    products += sums_.correlate(spectrum, region_spectra_.at(i));
    if (!whole_) t_sums.push_back(sums_.correlate(spectrum, region_mask_spectrum_));
  }
  cv::Mat squares(size_, CV_32F, cv::Scalar(0));
  if (whole_) {  // the sums are 0 and the squares are the same everywhere
    for (const cv::Mat& channel : channels) squares += cv::norm(channel, cv::NORM_L2SQR);
  } else {
    squares = sums_.correlate(sums_.spectrum(squares_of(channels)), region_mask_spectrum_);
  }
  for (std::size_t i = 0; i < t_sums.size(); ++i) {
    for (int row = 0; row < size_.height; ++row) {
      const auto* n = counts_.ptr<float>(row);
      const auto* t_sum = t_sums[i].ptr<float>(row);
      const auto* g_sum = region_sums_[i].ptr<float>(row);
      auto* out = products.ptr<float>(row);
      for (int col = 0; col < size_.width; ++col) out[col] -= t_sum[col] * g_sum[col] / std::max(n[col], 1.0F);
    }
  }
  return normalised(products, scatter(t_sums, squares));
}

cv::Mat MaskedCorrelation::normalised(const cv::Mat& products, const cv::Mat& t_scatter) const {
  cv::Mat result(size_, CV_32F);
  for (int row = 0; row < size_.height; ++row) {
    const auto* n = counts_.ptr<float>(row);
    const auto* product = products.ptr<float>(row);
    const auto* tt = t_scatter.ptr<float>(row);
    const auto* gg = region_scatter_.ptr<float>(row);
    auto* out = result.ptr<float>(row);
    for (int col = 0; col < size_.width; ++col) {
      // Flat where a scatter is 0; the product of two floats may overflow, their roots not.
      const float norm = std::sqrt(tt[col]) * std::sqrt(gg[col]);
      const float value = norm > 0 ? std::clamp(product[col] / norm, -1.0F, 1.0F) : 0.0F;
      out[col] = static_cast<double>(n[col]) >= needed_ ? value : kNotCompared;
    }
  }
  return result;
}

}  // namespace pilotage
