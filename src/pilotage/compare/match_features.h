#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pilotage/compare/descriptor_method.h"

namespace pilotage {

/// A frame's feature and its nearest one of the reference.
struct FeatureMatch {
  int frame = 0;  ///< Index of the feature.
  int reference = 0;
  float distance = 0;                                              ///< Bits, or Euclidean.
  float second_distance = std::numeric_limits<float>::infinity();  ///< Of the second nearest, if there is one.
};

/// The nearest reference feature of every feature of the frame, by brute force (cv::BFMatcher, Hamming for CV_8U, L2
/// for CV_32F descriptors). Sorted by distance, equal ones by frame feature: the first ten are "the best ten". Empty
/// when either has no features.
std::vector<FeatureMatch> match_by_brute_force(const DescribedImage& frame, const DescribedImage& reference);

/// Rotation, scale and shift from frame to reference pixels (centres at +0.5).
struct SimilarityFit {
  Eigen::Matrix<double, 2, 3> reference_from_frame = Eigen::Matrix<double, 2, 3>::Zero();
  int candidates = 0;  ///< Matches that passed the ratio test.
  int inliers = 0;     ///< Those that agree with the transform.

  double scale() const { return reference_from_frame.col(0).norm(); }
  Eigen::Vector2d reference_from_frame_px(const Eigen::Vector2d& frame_px) const {
    return reference_from_frame.leftCols<2>() * frame_px + reference_from_frame.col(2);
  }
};

struct SimilarityOptions {
  double ratio = 0.8;
  double threshold_px = 3;
};

/// The similarity that most matches agree with, among those whose distance is below `ratio` times that of their second
/// nearest (D. Lowe, IJCV 60, 2004): cv::estimateAffinePartial2D, RANSAC (M. Fischler, R. Bolles, Comm. ACM 24, 1981)
/// of 5,000 draws at most, refined by least squares over the inliers. `seed` orders the matches, and so decides the
/// draws. inliers = 0 when there is none; candidates is set always.
SimilarityFit fit_similarity(const DescribedImage& frame, const DescribedImage& reference,
                             const std::vector<FeatureMatch>& matches, const SimilarityOptions& options,
                             std::uint64_t seed);

}  // namespace pilotage
