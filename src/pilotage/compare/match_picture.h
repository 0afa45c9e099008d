#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace pilotage {

/// A match and what the truth says of it. Pixel centres at +0.5.
struct JudgedMatch {
  Eigen::Vector2d frame_px{0, 0};
  Eigen::Vector2d reference_px{0, 0};
  bool agrees = false;
};

/// One side of the picture: CV_8UC1, and the features that a method found on it.
struct FeaturedImage {
  cv::Mat gray;
  std::vector<Eigen::Vector2d> features_px;
};

/// Frame and reference side by side, each feature a small yellow dot, with a line for each match; the title says how
/// many agree with the truth, the legend how many features there are. Matches that agree are solid blue lines between
/// circles, the others dashed orange ones between crosses (colours of M. Okabe, K. Ito, "Color Universal Design",
/// 2008), so that no one has to tell colours apart. CV_8UC3, blue first; at most 1600 px wide. Throws UsageError for
/// images of another type.
cv::Mat draw_matches(std::string_view title, const FeaturedImage& frame, const FeaturedImage& reference,
                     const std::vector<JudgedMatch>& matches, double tolerance_m);

/// As a PNG file's bytes. Throws DataError when it cannot be encoded.
std::string png_bytes(const cv::Mat& bgr);

}  // namespace pilotage
