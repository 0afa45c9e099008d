#include "pilotage/degradation/degradation.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"
#include "pilotage/degradation/degradation_fields.h"

namespace pilotage {
namespace {

/// Sign of one effect in one copy: copies 2k and 2k + 1 differ in all of them, and the effects do not go together.
double sign_of(int copy, int effect) {
  const auto bits = static_cast<unsigned>(copy);
  const unsigned flips = effect == 0 ? bits : bits ^ (bits >> effect);
  return (flips & 1U) != 0 ? -1.0 : 1.0;
}

double deviation_of(const cv::Mat& values) {
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(values, mean, deviation);
  return deviation[0];
}

/// Where the pixels of the copy lie in the tile with its margin, in OpenCV's pixel coordinates (centres at whole
/// numbers).
cv::Mat source_positions(int size_px, int margin_px, double angle_rad, double scale) {
  const double centre = (size_px - 1) / 2.0;
  const double c = std::cos(angle_rad) * scale;
  const double s = std::sin(angle_rad) * scale;
  cv::Mat positions(size_px, size_px, CV_32FC2);
  for (int row = 0; row < size_px; ++row) {
    for (int col = 0; col < size_px; ++col) {
      const double dx = col - centre;
      const double dy = row - centre;
      positions.at<cv::Vec2f>(row, col) = {static_cast<float>(centre + margin_px + c * dx - s * dy),
                                           static_cast<float>(centre + margin_px + s * dx + c * dy)};
    }
  }
  return positions;
}

}  // namespace

int rotation_margin_px(int tile_size_px, const DegradationOptions& options) {
  const double angle = options.rotation_deg * std::numbers::pi / 180;
  const double half = tile_size_px / 2.0;
  const double turned = half * ((1 + options.scale_percent / 100) * (std::cos(angle) + std::sin(angle)) - 1);
  return options.rotation_deg == 0 && options.scale_percent == 0
             ? 0
             : static_cast<int>(std::ceil(std::max(turned, 0.0))) + 1;
}

Degrader::Degrader(int tile_size_px, int margin_px, const DegradationOptions& options, std::uint64_t seed, int copy)
    : options_(options), size_px_(tile_size_px), margin_px_(margin_px) {
  check_options(options);
  if (tile_size_px < 1 || margin_px < 0 || copy < 0) {
    throw UsageError("degraded copy: tile size " + std::to_string(tile_size_px) + ", margin " +
                     std::to_string(margin_px) + ", copy " + std::to_string(copy) + " are not allowed");
  }
  const std::uint64_t own = derive_seed(seed, static_cast<std::uint64_t>(copy));
  const auto stream = [own](std::string_view name) { return Random(derive_seed(own, seed_from_name(name))); };

  const double angle = sign_of(copy, 0) * options.rotation_deg * std::numbers::pi / 180;
  const double factor = 1 + options.scale_percent / 100;
  const double scale = sign_of(copy, 1) > 0 ? factor : 1 / factor;
  if (options.rotation_deg > 0 || options.scale_percent > 0) {
    map_xy_ = source_positions(tile_size_px, margin_px, angle, scale);
  }
  if (options.texture_redrawn > 0) {
    texture_ = texture_field(tile_size_px, options.texture_scale_px, stream("texture"));
  }
  if (options.illumination > 0) {
    illumination_ = wave_field(tile_size_px, options.illumination, stream("illumination"));
  }
  if (options.noise > 0) noise_ = white_field({tile_size_px, tile_size_px}, stream("noise"));
  gamma_ = sign_of(copy, 2) > 0 ? 1 + options.gamma : 1 / (1 + options.gamma);
}

cv::Mat Degrader::seen(const cv::Mat& tile) const {
  if (map_xy_.empty()) return tile(cv::Rect(margin_px_, margin_px_, size_px_, size_px_)).clone();
  cv::Mat picture;
  cv::remap(tile, picture, map_xy_, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REFLECT_101);
  return picture;
}

cv::Mat Degrader::redrawn(const cv::Mat& ground) const {
  cv::Mat coarse;
  blur(ground, coarse, options_.texture_scale_px);
  cv::Mat fine = ground - coarse;
  const cv::Mat strength = local_strength(fine, options_.texture_scale_px);
  const double share = options_.texture_redrawn;
  cv::Mat copy;
  cv::scaleAdd(fine, std::sqrt(1 - share * share), coarse, copy);
  cv::scaleAdd(strength.mul(texture_), share, copy, copy);
  return copy;
}

cv::Mat Degrader::apply(const cv::Mat& tile) const {
  const int side = size_px_ + 2 * margin_px_;
  if (tile.type() != CV_32FC1 || tile.rows != side || tile.cols != side) {
    throw UsageError("degraded copy needs a CV_32F tile of " + std::to_string(side) + " x " + std::to_string(side) +
                     " px");
  }
  cv::Mat copy = seen(tile);
  if (!texture_.empty()) copy = redrawn(copy);

  // Brightness effects act on gray values between 0 (darkest pixel) and 1 (brightest); correlation does not see the
  // change.
  double low = 0;
  double high = 0;
  cv::minMaxLoc(copy, &low, &high);
  if (!(high > low)) return cv::Mat::zeros(size_px_, size_px_, CV_32F);
  if (!illumination_.empty() || options_.gamma > 0) {
    copy.convertTo(copy, CV_32F, 1 / (high - low), -low / (high - low));
    if (!illumination_.empty()) cv::multiply(copy, illumination_, copy);
  }
  if (options_.gamma > 0) cv::pow(cv::max(copy, 0), gamma_, copy);
  if (options_.blur_px > 0) blur(copy, copy, options_.blur_px);
  if (!noise_.empty()) cv::scaleAdd(noise_, options_.noise * deviation_of(copy), copy, copy);
  return copy;
}

}  // namespace pilotage
