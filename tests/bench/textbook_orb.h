#pragma once

#include <vector>

#include <opencv2/features2d.hpp>

#include "pilotage/compare/match_features.h"

namespace pilotage::testing {

// The pipeline that papers and tutorials use, for measuring match() beside it: ORB (E. Rublee et al., ICCV 2011), brute
// force with the ratio test, a similarity by RANSAC (compare/match_features.h), all as OpenCV has them.

inline constexpr int kOrbFeatures = 1500;     // of a frame
inline constexpr int kOrbMapFeatures = 8000;  // of the window of the map

/// Unlike describe_image() in one pass, which is what a program that wants speed would do. `valid` (CV_8U) may be
/// empty. The threshold of FAST is low enough for `count` features on small frames.
inline DescribedImage orb_features(const cv::Mat& gray, const cv::Mat& valid, int count) {
  DescribedImage described;
  std::vector<cv::KeyPoint> points;
  cv::ORB::create(count, 1.2F, 8, 31, 0, 2, cv::ORB::HARRIS_SCORE, 31, 5)
      ->detectAndCompute(gray, valid, points, described.descriptors);
  for (const cv::KeyPoint& point : points) {
    described.points_px.emplace_back(static_cast<double>(point.pt.x) + 0.5, static_cast<double>(point.pt.y) + 0.5);
  }
  return described;
}

/// Where the frame lies on the map.
inline SimilarityFit place_by_orb(const DescribedImage& frame, const DescribedImage& map) {
  return fit_similarity(frame, map, match_by_brute_force(frame, map), {}, 1);
}

}  // namespace pilotage::testing
