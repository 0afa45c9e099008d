#include "pilotage/compare/surf_features.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

// SURF is all in dlib's headers. Without the bindings to BLAS, which it does not call, and the check that the program
// links libdlib in the same configuration, nothing of dlib has to be linked.
#include <dlib/assert.h>
#undef DLIB_USE_BLAS
#undef DLIB_USE_LAPACK
#define DLIB_TEST_FOR_ODR_VIOLATIONS_H_
#include <dlib/image_keypoint/surf.h>
#include <dlib/opencv/cv_image.h>

#include "pilotage/compare/stopwatch.h"

namespace pilotage {
namespace {

// dlib's own are 30 for the threshold, and these for the pyramid.
constexpr double kDetectionThreshold = 1;
constexpr long kOctaves = 4;
constexpr long kIntervals = 6;
constexpr long kFirstStepPx = 2;
constexpr double kBorderScales = 32;
constexpr int kDescriptorSize = 64;

// Sums of up to 2³² pixels of 8 bits fit.
using IntegralImage = dlib::integral_image_generic<std::int64_t>;

bool is_allowed(const IntegralImage& image, const cv::Mat& allowed, const dlib::interest_point& point) {
  const auto border = static_cast<unsigned long>(kBorderScales * point.scale);
  if (!dlib::get_rect(image).contains(dlib::centered_rect(point.center, border, border))) return false;
  const auto x = static_cast<int>(std::lround(point.center.x()));
  const auto y = static_cast<int>(std::lround(point.center.y()));
  return allowed.at<std::uint8_t>(y, x) != 0;
}

// The strongest allowed points, strongest first; equal ones by place.
std::vector<dlib::interest_point> detect(const IntegralImage& image, const cv::Mat& allowed, int max_features) {
  dlib::hessian_pyramid pyramid;
  pyramid.build_pyramid(image, kOctaves, kIntervals, kFirstStepPx);
  std::vector<dlib::interest_point> points;
  dlib::get_interest_points(pyramid, kDetectionThreshold, points);
  std::erase_if(points, [&](const dlib::interest_point& point) { return !is_allowed(image, allowed, point); });
  std::sort(points.begin(), points.end(), [](const dlib::interest_point& a, const dlib::interest_point& b) {
    if (a.score != b.score) return a.score > b.score;
    return a.center.y() != b.center.y() ? a.center.y() < b.center.y() : a.center.x() < b.center.x();
  });
  if (points.size() > static_cast<std::size_t>(max_features)) points.resize(static_cast<std::size_t>(max_features));
  return points;
}

}  // namespace

DescribedImage surf_features(const cv::Mat& gray, const cv::Mat& allowed, int max_features) {
  DescribedImage result;
  Stopwatch watch;
  IntegralImage image;
  image.load(dlib::cv_image<unsigned char>(gray));
  const std::vector<dlib::interest_point> points = detect(image, allowed, max_features);
  result.detect_ms = watch.lap_ms();

  result.descriptors.create(static_cast<int>(points.size()), kDescriptorSize, CV_32F);
  dlib::matrix<double, kDescriptorSize, 1> descriptor;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const dlib::interest_point& point = points[i];
    const double angle = dlib::compute_dominant_angle(image, point.center, point.scale);
    dlib::compute_surf_descriptor(image, point.center, point.scale, angle, descriptor);
    auto* row = result.descriptors.ptr<float>(static_cast<int>(i));
    for (int k = 0; k < kDescriptorSize; ++k) row[k] = static_cast<float>(descriptor(k));
    result.points_px.emplace_back(point.center.x() + 0.5, point.center.y() + 0.5);
  }
  result.describe_ms = watch.lap_ms();
  return result;
}

}  // namespace pilotage
