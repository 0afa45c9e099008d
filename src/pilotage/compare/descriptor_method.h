#pragma once

#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pilotage/base/options.h"

namespace pilotage {

/// Ways to find and describe features that are compared. docs/methods/descriptors.md has sources and settings.
enum class DescriptorMethod { kOrb, kGround64, kGround128, kGround256, kOrb256, kBrief128, kBrief512, kSift, kSurf };

inline EnumNames<DescriptorMethod> enum_names(DescriptorMethod) {
  return {{DescriptorMethod::kOrb, "orb"},
          {DescriptorMethod::kGround64, "ground_64"},
          {DescriptorMethod::kGround128, "ground_128"},
          {DescriptorMethod::kGround256, "ground_256"},
          {DescriptorMethod::kOrb256, "orb_256"},
          {DescriptorMethod::kBrief128, "brief_128"},
          {DescriptorMethod::kBrief512, "brief_512"},
          {DescriptorMethod::kSift, "sift"},
          {DescriptorMethod::kSurf, "surf"}};
}

/// "ORB", "Ground-256": what tables and file names say.
std::string_view descriptor_method_title(DescriptorMethod method);

/// Features of one image and how long they took on one thread.
struct DescribedImage {
  std::vector<Eigen::Vector2d> points_px;  ///< Centres of pixels lie at +0.5.
  cv::Mat descriptors;                     ///< One row for each point: CV_8U (compared by Hamming) or CV_32F (by L2).
  double detect_ms = 0;
  double describe_ms = 0;
};

/// Features of `gray` (CV_8UC1) whose centres lie where `allowed` (same size, CV_8UC1) is not 0; the strongest, about
/// `max_features` of them.
///
///   ORB        cv::ORB: oFAST on 8 scales, 256 oriented bits (E. Rublee et al., ICCV 2011).
///   Ground-n, ORB-256, BRIEF-n
///              vision/features.h, what maps store: FAST-9 corners spread evenly on one scale, n upright tests: learned
///              on ground (vision/ground_pattern.h), ORB's pairs, or drawn (M. Calonder et al., ECCV 2010).
///   SIFT       cv::SIFT: 128 numbers (D. Lowe, IJCV 60, 2004).
///   SURF       dlib: fast Hessian, 64 numbers, oriented (H. Bay et al., CVIU 110, 2008).
///
/// Detectors' thresholds are low, so that each finds its number of features wherever there is texture. Detection and
/// description are timed apart; OpenCV builds the image pyramid of ORB and of SIFT in both. Points and descriptors are
/// deterministic. An image with a side below 64 px has none. Throws UsageError for matrices other than these or
/// max_features < 1.
DescribedImage describe_image(DescriptorMethod method, const cv::Mat& gray, const cv::Mat& allowed, int max_features);

}  // namespace pilotage
