#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace pilotage {

inline constexpr double kRootScale = 512;

/// SIFT features of a frame, the coarsest first (D. Lowe, "Distinctive image features from scale-invariant keypoints",
/// IJCV 60, 2004; OpenCV's).
struct FrameFeatures {
  std::vector<Eigen::Vector2d> pixels;  ///< In the frame at full size, pixel centres at +0.5.
  /// CV_8U, a row of 128 for each: square roots of the histogram of sum 1, times kRootScale (R. Arandjelović, A.
  /// Zisserman, "Three things everyone should know to improve object retrieval", CVPR 2012).
  cv::Mat descriptors;
  double pixel_sigma_px = 1;  ///< How well `pixels` are known: two thirds of a pixel of the size they were found at.
  std::string digest;         ///< Of all of these, BLAKE2b-256, where a MatchFolder keeps them; else "".
};

/// What is kept of a picture's pixels.
struct FramePicture {
  FrameFeatures features;
  cv::Mat small;  ///< CV_8UC3, RGB, a long side of at most 400 px; empty where the picture could not be read.
};

/// Features of a CV_8U picture, found at a long side of at most 1,600 px: of each of 24 × 18 cells the strongest, some
/// 4,500 in all. Fewer in a picture with little in it. Deterministic.
FrameFeatures find_frame_features(const cv::Mat& gray8);

}  // namespace pilotage
