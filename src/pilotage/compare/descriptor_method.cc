#include "pilotage/compare/descriptor_method.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include <opencv2/features2d.hpp>

#include "pilotage/base/error.h"
#include "pilotage/compare/stopwatch.h"
#include "pilotage/compare/surf_features.h"
#include "pilotage/vision/feature_descriptor.h"
#include "pilotage/vision/feature_detector.h"
#include "pilotage/vision/features.h"

namespace pilotage {
namespace {

// Lower than OpenCV's own 20 and 0.04: those leave faint ground without features.
constexpr int kOrbFastThreshold = 5;
constexpr double kSiftContrastThreshold = 0.01;

// A descriptor of 31 px and its margins need as much; the pyramids of OpenCV and dlib fail on less than a few pixels.
constexpr int kMinSidePx = 64;

/// The descriptor of maps that a method stands for: the one of its name.
const BinaryDescriptor& descriptor_of_method(DescriptorMethod method) {
  const std::string name = options_detail::enum_to_name(method);
  const auto* const found = std::find_if(kBinaryDescriptors.begin(), kBinaryDescriptors.end(),
                                         [&](const BinaryDescriptor& row) { return descriptor_name(row) == name; });
  if (found == kBinaryDescriptors.end()) throw std::logic_error("no binary descriptor has the name " + name);
  return *found;
}

// The detector and descriptor of extract_features_of_map() with one octave, one after the other.
DescribedImage binary_features(const BinaryDescriptor& descriptor, const cv::Mat& gray, const cv::Mat& allowed,
                               int max_features) {
  const FeatureOptions options;
  const int margin = descriptor.reach_px;
  const cv::Rect area(margin, margin, gray.cols - 2 * margin, gray.rows - 2 * margin);
  DescribedImage result;
  if (area.width < 1 || area.height < 1) return result;
  const int allowed_px = cv::countNonZero(allowed(area));
  if (allowed_px == 0) return result;

  Stopwatch watch;
  const CornerOptions corner_options{std::min(1.0, static_cast<double>(max_features) / allowed_px),
                                     options.fast_threshold, options.min_fast_threshold};
  const std::vector<Corner> corners = find_corners(gray, allowed, area, corner_options);
  result.detect_ms = watch.lap_ms();
  const std::vector<std::uint8_t> descriptors = describe_corners(gray, corners, descriptor);
  result.describe_ms = watch.lap_ms();

  for (const Corner& corner : corners) result.points_px.emplace_back(corner.x + 0.5, corner.y + 0.5);
  if (corners.empty()) return result;
  result.descriptors = cv::Mat(descriptors, true).reshape(1, static_cast<int>(corners.size()));
  return result;
}

DescribedImage opencv_features(cv::Feature2D& method, const cv::Mat& gray, const cv::Mat& allowed) {
  DescribedImage result;
  std::vector<cv::KeyPoint> keypoints;
  Stopwatch watch;
  method.detect(gray, keypoints, allowed);
  result.detect_ms = watch.lap_ms();
  method.compute(gray, keypoints, result.descriptors);
  result.describe_ms = watch.lap_ms();
  for (const cv::KeyPoint& keypoint : keypoints) {
    result.points_px.emplace_back(keypoint.pt.x + 0.5, keypoint.pt.y + 0.5);
  }
  return result;
}

}  // namespace

std::string_view descriptor_method_title(DescriptorMethod method) {
  switch (method) {
    case DescriptorMethod::kOrb:
      return "ORB";
    case DescriptorMethod::kGround64:
      return "Ground-64";
    case DescriptorMethod::kGround128:
      return "Ground-128";
    case DescriptorMethod::kGround256:
      return "Ground-256";
    case DescriptorMethod::kOrb256:
      return "ORB-256";
    case DescriptorMethod::kBrief128:
      return "BRIEF-128";
    case DescriptorMethod::kBrief512:
      return "BRIEF-512";
    case DescriptorMethod::kSift:
      return "SIFT";
    case DescriptorMethod::kSurf:
      return "SURF";
  }
  return "";
}

DescribedImage describe_image(DescriptorMethod method, const cv::Mat& gray, const cv::Mat& allowed, int max_features) {
  if (gray.type() != CV_8UC1 || allowed.type() != CV_8UC1 || gray.size() != allowed.size() || gray.empty()) {
    throw UsageError("features need a gray image of 8 bits and a mask of its size");
  }
  if (max_features < 1) throw UsageError("max_features = " + std::to_string(max_features) + ": allowed is 1 or more");
  if (std::min(gray.rows, gray.cols) < kMinSidePx) return {};
  switch (method) {
    case DescriptorMethod::kOrb:
      return opencv_features(
          *cv::ORB::create(max_features, 1.2F, 8, 31, 0, 2, cv::ORB::HARRIS_SCORE, 31, kOrbFastThreshold), gray,
          allowed);
    case DescriptorMethod::kSift:
      return opencv_features(*cv::SIFT::create(max_features, 3, kSiftContrastThreshold), gray, allowed);
    case DescriptorMethod::kSurf:
      return surf_features(gray, allowed, max_features);
    default:
      return binary_features(descriptor_of_method(method), gray, allowed, max_features);
  }
}

}  // namespace pilotage
