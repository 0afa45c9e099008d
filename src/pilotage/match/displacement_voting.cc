#include "pilotage/match/displacement_voting.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>

#include "pilotage/vision/hamming.h"

namespace pilotage {
namespace {

/// A descriptor of the map and one of the frame that look alike.
struct Pair {
  Eigen::Vector2d from_pivot_px;
  Eigen::Vector2d map_px;
  double turn_rad = 0;  ///< Map angle − frame angle, of oriented descriptors.
  double weight = 0;
};

double distance_of_angles(double a_rad, double b_rad) {
  return std::abs(std::remainder(a_rad - b_rad, 2 * std::numbers::pi));
}

/// Where in the frame a map feature may appear: its place under the middle of the search space, and how far off.
struct Reach {
  Eigen::Vector2d center_px;
  double half_width_px;
};

Reach reach_in_frame(const PivotedFrame& frame, const SearchSpace& space, const Eigen::Vector2d& map_px) {
  if (space.yaw_sigma_rad > kUnknownYawRad) return {frame.pivot_px, frame.radius_px};
  const double turned_px = frame.radius_px * (2 * space.yaw_sigma_rad + 2 * space.scale_sigma);
  return {map_px - space.center_px + frame.pivot_px, space.half_width_px + turned_px};
}

std::vector<Pair> similar_pairs(const PivotedFrame& frame, const LocalMap& map, const SearchSpace& space) {
  const HammingIndex index(frame.grid.points);
  std::vector<HammingWindow> windows;
  windows.reserve(map.features.size());
  for (const Feature& feature : map.features.features) {
    const Reach reach =
        reach_in_frame(frame, space, {static_cast<double>(feature.x_px), static_cast<double>(feature.y_px)});
    windows.push_back({reach.center_px.x() - reach.half_width_px, reach.center_px.y() - reach.half_width_px,
                       reach.center_px.x() + reach.half_width_px, reach.center_px.y() + reach.half_width_px});
  }
  const HammingMatches nearest = index.find_nearest(map.features, windows, kVoteNeighbours);
  const double limit_bits = kVoteDistance * 8 * map.features.descriptor_bytes;
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < map.features.size(); ++i) {
    const Feature& of_map = map.features.features[i];
    for (const HammingMatch& match : nearest.of_query(i)) {
      if (!match.found() || match.distance >= limit_bits) break;
      const Feature& of_frame = frame.grid.points.features[match.index];
      const double nearness = 1 - match.distance / limit_bits;
      pairs.push_back(
          {Eigen::Vector2d(static_cast<double>(of_frame.x_px), static_cast<double>(of_frame.y_px)) - frame.pivot_px,
           {static_cast<double>(of_map.x_px), static_cast<double>(of_map.y_px)},
           static_cast<double>(of_map.angle_deg - of_frame.angle_deg) * std::numbers::pi / 180,
           nearness * nearness});
    }
  }
  return pairs;
}

/// Evenly spaced values over ± 2 sigma about `middle`, at most `step` apart.
std::vector<double> hypotheses(double middle, double sigma, double step) {
  const int count = static_cast<int>(std::ceil(2 * sigma / step));
  std::vector<double> values;
  for (int i = -count; i <= count; ++i) values.push_back(middle + i * (count == 0 ? 0 : 2 * sigma / count));
  return values;
}

std::vector<double> yaw_hypotheses_rad(const SearchSpace& space, double step_rad) {
  if (space.yaw_sigma_rad <= kUnknownYawRad) return hypotheses(0, space.yaw_sigma_rad, step_rad);
  const int count = static_cast<int>(std::ceil(2 * std::numbers::pi / step_rad));
  std::vector<double> values;
  for (int i = 0; i < count; ++i)
    values.push_back(std::remainder(2 * std::numbers::pi * i / count, 2 * std::numbers::pi));
  return values;
}

cv::Mat histogram_of(const std::vector<Pair>& pairs, const SearchSpace& space, const Placement& turned,
                     double max_turn_error_rad) {
  const int bins = static_cast<int>(2 * space.half_width_px / kVoteBinPx) + 3;
  cv::Mat histogram = cv::Mat::zeros(bins, bins, CV_32FC1);
  const Eigen::Vector2d corner_px = space.center_px - Eigen::Vector2d::Constant(space.half_width_px + kVoteBinPx / 2);
  for (const Pair& pair : pairs) {
    if (space.oriented && distance_of_angles(pair.turn_rad, turned.yaw_rad) > max_turn_error_rad) continue;
    const Eigen::Vector2d place = (pair.map_px - turned.map_from_frame(pair.from_pivot_px) - corner_px) / kVoteBinPx;
    if (!(place.minCoeff() >= 0 && place.maxCoeff() < bins)) continue;
    histogram.at<float>(static_cast<int>(place.y()), static_cast<int>(place.x())) += static_cast<float>(pair.weight);
  }
  cv::GaussianBlur(histogram, histogram, cv::Size(5, 5), 1);
  return histogram;
}

/// Bins that are the highest of the 5 × 5 around them.
void append_peaks(const cv::Mat& histogram, const SearchSpace& space, const Placement& turned,
                  std::vector<Candidate>& candidates) {
  constexpr float kMinVotes = 0.1F;
  cv::Mat highest;
  cv::dilate(histogram, highest, cv::Mat::ones(5, 5, CV_8U));
  for (int row = 0; row < histogram.rows; ++row) {
    const auto* const values = histogram.ptr<float>(row);
    const auto* const maxima = highest.ptr<float>(row);
    for (int col = 0; col < histogram.cols; ++col) {
      if (values[col] < kMinVotes || values[col] < maxima[col]) continue;
      Placement placement = turned;
      placement.center_px =
          space.center_px - Eigen::Vector2d::Constant(space.half_width_px) + kVoteBinPx * Eigen::Vector2d(col, row);
      candidates.push_back({placement, static_cast<double>(values[col])});
    }
  }
}

/// The best `count`, none nearer than kPeakSeparationPx to a better one.
std::vector<Candidate> separated(std::vector<Candidate> candidates, std::size_t count) {
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.votes > b.votes; });
  std::vector<Candidate> kept;
  for (const Candidate& candidate : candidates) {
    if (kept.size() >= count) break;
    const bool near = std::any_of(kept.begin(), kept.end(), [&](const Candidate& better) {
      return (better.placement.center_px - candidate.placement.center_px).norm() < kPeakSeparationPx;
    });
    if (!near) kept.push_back(candidate);
  }
  return kept;
}

}  // namespace

Eigen::Vector2d Placement::map_from_frame(const Eigen::Vector2d& from_pivot_px) const {
  const double c = scale * std::cos(yaw_rad);
  const double s = scale * std::sin(yaw_rad);
  return center_px +
         Eigen::Vector2d(c * from_pivot_px.x() - s * from_pivot_px.y(), s * from_pivot_px.x() + c * from_pivot_px.y());
}

Eigen::Vector2d Placement::frame_from_map(const Eigen::Vector2d& map_px) const {
  const Eigen::Vector2d d = (map_px - center_px) / scale;
  const double c = std::cos(yaw_rad);
  const double s = std::sin(yaw_rad);
  return {c * d.x() + s * d.y(), -s * d.x() + c * d.y()};
}

std::vector<Candidate> vote_for_displacements(const PivotedFrame& frame, const LocalMap& map, const SearchSpace& space,
                                              std::size_t count) {
  const std::vector<Pair> pairs = similar_pairs(frame, map, space);
  const double step = kVoteStepPx / std::max(frame.radius_px, 1.0);
  const double max_turn_error_rad = std::max(20 * std::numbers::pi / 180, step);
  std::vector<Candidate> candidates;
  for (const double yaw_rad : yaw_hypotheses_rad(space, step)) {
    for (const double scale : hypotheses(1, space.scale_sigma, step)) {
      const Placement turned{{0, 0}, yaw_rad, scale};
      append_peaks(histogram_of(pairs, space, turned, max_turn_error_rad), space, turned, candidates);
    }
    // Only the best may matter; the list stays short however many hypotheses there are.
    if (candidates.size() > 64 * count) candidates = separated(std::move(candidates), 4 * count);
  }
  return separated(std::move(candidates), count);
}

}  // namespace pilotage
