#include "pilotage/degradation/degradation_effects.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/degradation/degradation_fields.h"

namespace pilotage {
namespace {

constexpr double kWaterScale_px = 4;   // over which "flat" and "dark" are judged
constexpr double kWaterLevel_px = 12;  // over which the brightness of water stays

/// 0 where `values` ≤ `low`, 1 where ≥ `high`, straight between.
cv::Mat ramp(const cv::Mat& values, double low, double high) {
  cv::Mat result = (values - low) / (high - low);
  return cv::min(cv::max(result, 0.0), 1.0);
}

/// Weight 1 inside a rectangle a × b turned by `angle_rad`, falling to 0 over one pixel at its sides.
cv::Mat turned_rectangle(int width_px, int height_px, double a, double b, double angle_rad) {
  cv::Mat weight(height_px, width_px, CV_32F);
  const double c = std::cos(angle_rad);
  const double s = std::sin(angle_rad);
  for (int row = 0; row < height_px; ++row) {
    for (int col = 0; col < width_px; ++col) {
      const double x = col + 0.5 - width_px / 2.0;
      const double y = row + 0.5 - height_px / 2.0;
      const double along = std::clamp(a / 2 + 0.5 - std::abs(c * x + s * y), 0.0, 1.0);
      const double across = std::clamp(b / 2 + 0.5 - std::abs(c * y - s * x), 0.0, 1.0);
      weight.at<float>(row, col) = static_cast<float>(along * across);
    }
  }
  return weight;
}

/// Whole number with the given mean: the two next to it, in turn by chance.
int draw_count(double mean, Random& random) {
  const double whole = std::floor(mean);
  return static_cast<int>(whole) + (random.uniform() < mean - whole ? 1 : 0);
}

}  // namespace

std::vector<MovedObject> draw_objects(int size_px, double per_mpx, double object_size_px, Random random) {
  std::vector<MovedObject> objects;
  const int count = draw_count(per_mpx * size_px * size_px / 1e6, random);
  for (int i = 0; i < count; ++i) {
    const double a = object_size_px * random.uniform(0.5, 1.5);
    const double b = object_size_px * random.uniform(0.5, 1.5);
    const double angle = random.uniform(0, std::numbers::pi);
    const double direction = random.uniform(0, 2 * std::numbers::pi);
    const double distance = object_size_px * random.uniform(1, 4);
    const double place_x = random.uniform();
    const double place_y = random.uniform();
    const double c = std::abs(std::cos(angle));
    const double s = std::abs(std::sin(angle));
    const int width = static_cast<int>(std::ceil(a * c + b * s)) + 1;
    const int height = static_cast<int>(std::ceil(a * s + b * c)) + 1;
    if (width > size_px || height > size_px) continue;
    MovedObject object;
    // Places are uniform over all that overlap the picture by half, so that its border is as full as its middle.
    const cv::Point at(static_cast<int>(std::floor(place_x * size_px - width / 2.0)),
                       static_cast<int>(std::floor(place_y * size_px - height / 2.0)));
    object.to = cv::Rect(at, cv::Size(width, height)) & cv::Rect(0, 0, size_px, size_px);
    if (object.to.empty()) continue;
    object.weight = turned_rectangle(width, height, a, b, angle)(object.to - at).clone();
    const auto beside = [size_px](int place, int side, double step) {
      const int there = place + static_cast<int>(std::lround(step));
      const int back = place - static_cast<int>(std::lround(step));
      const int last = size_px - side;
      return there >= 0 && there <= last ? there : std::clamp(back, 0, last);
    };
    object.from = {beside(object.to.x, object.to.width, distance * std::cos(direction)),
                   beside(object.to.y, object.to.height, distance * std::sin(direction))};
    objects.push_back(object);
  }
  return objects;
}

void move_objects(const std::vector<MovedObject>& objects, cv::Mat& picture) {
  if (objects.empty()) return;
  const cv::Mat before = picture.clone();
  for (const MovedObject& object : objects) {
    cv::Mat to = picture(object.to);
    const cv::Mat shown = before(cv::Rect(object.from, object.to.size()));
    cv::Mat change = (shown - to).mul(object.weight);
    to += change;
  }
}

cv::Mat water_mask(const cv::Mat& picture) {
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(picture, mean, deviation);
  if (!(deviation[0] > 0)) return cv::Mat::zeros(picture.size(), CV_32F);
  cv::Mat level;
  blur(picture, level, kWaterScale_px);
  const cv::Mat roughness = local_strength(picture - level, kWaterScale_px) / deviation[0];
  const cv::Mat darkness = (mean[0] - level) / deviation[0];
  return ramp(darkness, 0.25, 0.75).mul(1 - ramp(roughness, 0.2, 0.4));
}

cv::Mat water_field(int size_px, Random random) {
  cv::Mat ripples;
  blur(white_field(size_px, Random(random.next())), ripples, 1);
  cv::Mat patches;
  blur(white_field(size_px, Random(random.next())), patches, 4);
  return normalised(normalised(ripples) + normalised(patches));
}

void redraw_water(double share, const cv::Mat& field, cv::Mat& picture) {
  const cv::Mat mask = water_mask(picture);
  if (cv::countNonZero(mask) == 0) return;
  // Means over the water alone: the shore's brightness must not enter.
  cv::Mat weight;
  blur(mask, weight, kWaterLevel_px);
  weight = cv::max(weight, 1e-6);
  cv::Mat level;
  blur(mask.mul(picture), level, kWaterLevel_px);
  level /= weight;
  const cv::Mat waves = picture - level;
  cv::Mat strength;
  blur(mask.mul(waves.mul(waves)), strength, kWaterLevel_px);
  cv::sqrt(strength / weight, strength);

  const cv::Mat drawn = share * mask;
  cv::Mat kept;
  cv::sqrt(1 - drawn.mul(drawn), kept);
  const cv::Mat fresh = level + kept.mul(waves) + drawn.mul(strength).mul(field);
  fresh.copyTo(picture, mask > 0);
}

cv::Mat guess_heights(const cv::Mat& picture, double scale_px) {
  cv::Mat level;
  blur(picture, level, scale_px);
  const cv::Mat strength = local_strength(picture - level, scale_px);
  const double mean_strength = cv::mean(strength)[0];
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(picture, mean, deviation);
  if (!(mean_strength > 0) || !(deviation[0] > 0)) return cv::Mat::zeros(picture.size(), CV_32F);
  const cv::Mat rough = cv::max(strength / mean_strength - 1, 0.0);
  const cv::Mat bright = cv::max((level - mean[0]) / deviation[0], 0.0);
  cv::Mat heights = cv::min(0.5 * (rough + bright), 1.0);
  blur(heights, heights, scale_px);
  return heights;
}

}  // namespace pilotage
