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

/// Pairs with a column for each number, so that many are turned at once.
struct PairColumns {
  explicit PairColumns(const std::vector<Pair>& pairs) {
    const auto count = static_cast<Eigen::Index>(pairs.size());
    for (Eigen::ArrayXd* column : {&frame_x_px, &frame_y_px, &map_x_px, &map_y_px}) column->resize(count);
    weight.reserve(pairs.size());
    for (Eigen::Index i = 0; i < count; ++i) {
      const Pair& pair = pairs[static_cast<std::size_t>(i)];
      frame_x_px(i) = pair.from_pivot_px.x();
      frame_y_px(i) = pair.from_pivot_px.y();
      map_x_px(i) = pair.map_px.x();
      map_y_px(i) = pair.map_px.y();
      weight.push_back(static_cast<float>(pair.weight));
    }
  }

  Eigen::ArrayXd frame_x_px;  ///< From the frame's pivot.
  Eigen::ArrayXd frame_y_px;
  Eigen::ArrayXd map_x_px;
  Eigen::ArrayXd map_y_px;
  std::vector<float> weight;
};

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
  const double limit_bits = descriptor_of(map.features).vote_distance * 8 * map.features.descriptor_bytes;
  const HammingMatches nearest = index.find_nearest(map.features, windows, kVoteNeighbours, best_hamming_path(),
                                                    static_cast<std::uint32_t>(std::ceil(limit_bits)) - 1);
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < map.features.size(); ++i) {
    const Feature& of_map = map.features.features[i];
    for (const HammingMatch& match : nearest.of_query(i)) {
      if (!match.found()) break;
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

/// The pairs whose angles differ by this turn, within `max_error_rad`.
std::vector<Pair> pairs_turned_by(const std::vector<Pair>& pairs, double yaw_rad, double max_error_rad) {
  std::vector<Pair> turned;
  for (const Pair& pair : pairs) {
    double error_rad =
        std::abs(pair.turn_rad - yaw_rad);  // below 3π: two angles differ by less than 2π, yaw is within π
    if (error_rad > std::numbers::pi) error_rad = std::abs(error_rad - 2 * std::numbers::pi);
    if (error_rad <= max_error_rad) turned.push_back(pair);
  }
  return turned;
}

cv::Mat histogram_of(const PairColumns& pairs, const SearchSpace& space, const Placement& turned) {
  constexpr Eigen::Index kChunk = 512;
  const int bins = static_cast<int>(2 * space.half_width_px / kVoteBinPx) + 3;
  cv::Mat histogram = cv::Mat::zeros(bins, bins, CV_32FC1);
  const Eigen::Vector2d corner_px = space.center_px - Eigen::Vector2d::Constant(space.half_width_px + kVoteBinPx / 2);
  const double c = turned.scale * std::cos(turned.yaw_rad);
  const double s = turned.scale * std::sin(turned.yaw_rad);
  using Chunk = Eigen::Array<double, Eigen::Dynamic, 1, 0, kChunk, 1>;
  const auto count = static_cast<Eigen::Index>(pairs.weight.size());
  for (Eigen::Index first = 0; first < count; first += kChunk) {
    const Eigen::Index n = std::min(kChunk, count - first);
    const auto frame_x = pairs.frame_x_px.segment(first, n);
    const auto frame_y = pairs.frame_y_px.segment(first, n);
    const Chunk col = (pairs.map_x_px.segment(first, n) - (c * frame_x - s * frame_y) - corner_px.x()) / kVoteBinPx;
    const Chunk row = (pairs.map_y_px.segment(first, n) - (s * frame_x + c * frame_y) - corner_px.y()) / kVoteBinPx;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (!(col(i) >= 0 && row(i) >= 0 && col(i) < bins && row(i) < bins)) continue;
      histogram.ptr<float>(static_cast<int>(row(i)))[static_cast<int>(col(i))] +=
          pairs.weight[static_cast<std::size_t>(first + i)];
    }
  }
  cv::GaussianBlur(histogram, histogram, cv::Size(5, 5), 1);
  return histogram;
}

/// Bins that are the highest of the 5 × 5 around them.
void append_peaks(const cv::Mat& histogram, const SearchSpace& space, const Placement& turned,
                  std::vector<Candidate>& candidates) {
  constexpr double kMinVotes = 0.1;
  cv::Mat highest;
  cv::dilate(histogram, highest, cv::Mat::ones(5, 5, CV_8U));
  cv::max(highest, kMinVotes, highest);
  std::vector<cv::Point> bins;
  cv::findNonZero(histogram >= highest, bins);
  for (const cv::Point& bin : bins) {
    Placement placement = turned;
    placement.center_px =
        space.center_px - Eigen::Vector2d::Constant(space.half_width_px) + kVoteBinPx * Eigen::Vector2d(bin.x, bin.y);
    candidates.push_back({placement, static_cast<double>(histogram.at<float>(bin))});
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
  return PlacementTransform(*this).map_from_frame(from_pivot_px);
}

Eigen::Vector2d Placement::frame_from_map(const Eigen::Vector2d& map_px) const {
  return PlacementTransform(*this).frame_from_map(map_px);
}

double search_bins(const PivotedFrame& frame, const SearchSpace& space) {
  const double step = kVoteStepPx / std::max(frame.radius_px, 1.0);
  const double side = 2 * space.half_width_px / kVoteBinPx + 3;
  const double turns = space.yaw_sigma_rad > kUnknownYawRad ? 2 * std::numbers::pi / step + 1
                                                            : 2 * std::ceil(2 * space.yaw_sigma_rad / step) + 1;
  return side * side * turns * (2 * std::ceil(2 * space.scale_sigma / step) + 1);
}

std::vector<Candidate> vote_for_displacements(const PivotedFrame& frame, const LocalMap& map, const SearchSpace& space,
                                              std::size_t count) {
  const std::vector<Pair> pairs = similar_pairs(frame, map, space);
  const double step = kVoteStepPx / std::max(frame.radius_px, 1.0);
  const double max_turn_error_rad = std::max(20 * std::numbers::pi / 180, step);
  std::vector<Candidate> candidates;
  PairColumns columns(pairs);
  for (const double yaw_rad : yaw_hypotheses_rad(space, step)) {
    if (space.oriented) columns = PairColumns(pairs_turned_by(pairs, yaw_rad, max_turn_error_rad));
    for (const double scale : hypotheses(1, space.scale_sigma, step)) {
      const Placement turned{{0, 0}, yaw_rad, scale};
      append_peaks(histogram_of(columns, space, turned), space, turned, candidates);
    }
    // Only the best may matter; the list stays short however many hypotheses there are.
    if (candidates.size() > 64 * count) candidates = separated(std::move(candidates), 4 * count);
  }
  return separated(std::move(candidates), count);
}

}  // namespace pilotage
