#include "pilotage/compare/match_features.h"

#include <algorithm>

#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>
#include <opencv2/features2d.hpp>

#include "pilotage/base/random.h"

namespace pilotage {
namespace {

constexpr int kRansacDraws = 5000;
constexpr double kRansacConfidence = 0.999;
constexpr int kRefineSteps = 10;

cv::Point2d opencv_point(const Eigen::Vector2d& point) {
  return {point.x(), point.y()};
}

void shuffle(std::vector<FeatureMatch>& matches, std::uint64_t seed) {
  Random random(seed);
  for (std::size_t i = matches.size(); i > 1; --i) std::swap(matches[i - 1], matches[random.below(i)]);
}

}  // namespace

std::vector<FeatureMatch> match_by_brute_force(const DescribedImage& frame, const DescribedImage& reference) {
  std::vector<FeatureMatch> matches;
  if (frame.descriptors.empty() || reference.descriptors.empty()) return matches;
  std::vector<std::vector<cv::DMatch>> nearest;
  const cv::BFMatcher matcher(frame.descriptors.depth() == CV_8U ? cv::NORM_HAMMING : cv::NORM_L2);
  matcher.knnMatch(frame.descriptors, reference.descriptors, nearest, 2);
  for (const std::vector<cv::DMatch>& two : nearest) {
    if (two.empty()) continue;
    FeatureMatch match{two[0].queryIdx, two[0].trainIdx, two[0].distance};
    if (two.size() > 1) match.second_distance = two[1].distance;
    matches.push_back(match);
  }
  std::sort(matches.begin(), matches.end(), [](const FeatureMatch& a, const FeatureMatch& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.frame < b.frame;
  });
  return matches;
}

SimilarityFit fit_similarity(const DescribedImage& frame, const DescribedImage& reference,
                             const std::vector<FeatureMatch>& matches, const SimilarityOptions& options,
                             std::uint64_t seed) {
  std::vector<FeatureMatch> candidates;
  for (const FeatureMatch& match : matches) {
    if (match.distance < options.ratio * match.second_distance) candidates.push_back(match);
  }
  SimilarityFit fit;
  fit.candidates = static_cast<int>(candidates.size());
  if (candidates.size() < 2) return fit;
  shuffle(candidates, seed);
  std::vector<cv::Point2d> from;
  std::vector<cv::Point2d> to;
  for (const FeatureMatch& match : candidates) {
    from.push_back(opencv_point(frame.points_px[static_cast<std::size_t>(match.frame)]));
    to.push_back(opencv_point(reference.points_px[static_cast<std::size_t>(match.reference)]));
  }
  std::vector<std::uint8_t> inliers;
  const cv::Mat transform = cv::estimateAffinePartial2D(from, to, inliers, cv::RANSAC, options.threshold_px,
                                                        kRansacDraws, kRansacConfidence, kRefineSteps);
  if (transform.empty()) return fit;
  cv::cv2eigen(transform, fit.reference_from_frame);
  fit.inliers = static_cast<int>(std::count(inliers.begin(), inliers.end(), 1));
  return fit;
}

}  // namespace pilotage
