#include "pilotage/match/guided_matching.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <Eigen/Cholesky>

#include "pilotage/vision/hamming_distance.h"

namespace pilotage {
namespace {

constexpr double kFitNoisePx = 2;
constexpr double kIndependentPairs = 50;  // what many overlapping patches are worth, against the prior
constexpr int kMaxReach = 2;              // in grid steps

double bits(const LocalMap& map) {
  return 8.0 * map.features.descriptor_bytes;
}

/// Offset of the lowest point of the parabola through three distances one step apart, in steps within ± 0.5.
double parabola_offset(double before, double middle, double after) {
  const double curvature = before - 2 * middle + after;
  return curvature <= 0 ? 0 : std::clamp((before - after) / (2 * curvature), -0.5, 0.5);
}

class GuidedSearch {
 public:
  GuidedSearch(const PivotedFrame& frame, const LocalMap& map) : frame_(frame), map_(map) {}

  /// The features of the map that may lie on a point of the frame, in their order: the others are too far from the
  /// centre for any turn.
  std::vector<std::size_t> features_within(const Placement& placement) const {
    const double level_reach_px = placement.scale * (frame_.radius_px + frame_.grid.step_px);
    const double nadir_px = placement.scale * (frame_.nadir_px - frame_.pivot_px).norm();
    std::vector<std::size_t> within;
    for (std::size_t i = 0; i < map_.features.size(); ++i) {
      const Feature& feature = map_.features.features[i];
      const double dx = static_cast<double>(feature.x_px) - placement.center_px.x();
      const double dy = static_cast<double>(feature.y_px) - placement.center_px.y();
      const double stretch = map_.stretch_of(i);
      const double reach_px = stretch * level_reach_px + std::abs(1 - stretch) * nadir_px;
      if (dx * dx + dy * dy <= reach_px * reach_px) within.push_back(i);
    }
    return within;
  }

  /// The best pair for a feature within `reach` grid steps of its expected place, or nothing when the frame has no
  /// point there.
  std::optional<GuidedPair> find(std::size_t feature, const PlacementTransform& placement, int reach) const {
    const FrameGrid& grid = frame_.grid;
    const Feature& of_map = map_.features.features[feature];
    GuidedPair pair;
    pair.map_feature = feature;
    pair.map_px = {static_cast<double>(of_map.x_px), static_cast<double>(of_map.y_px)};
    const double stretch = map_.stretch_of(feature);
    const Eigen::Vector2d expected =
        frame_.stretched(placement.frame_from_map(pair.map_px), 1 / stretch) + frame_.pivot_px;
    const double column = std::round((expected.x() - 0.5) / grid.step_px);
    const double row = std::round((expected.y() - 0.5) / grid.step_px);
    if (!(column >= 0 && row >= 0 && column < grid.columns && row < grid.rows)) return std::nullopt;
    if (grid.at(static_cast<int>(column), static_cast<int>(row)) < 0) return std::nullopt;

    std::array<const std::uint8_t*, (2 * kMaxReach + 1) * (2 * kMaxReach + 1)> candidates;
    std::array<std::int32_t, (2 * kMaxReach + 1) * (2 * kMaxReach + 1)> points;
    std::size_t count = 0;
    const int middle_column = static_cast<int>(column);
    const int middle_row = static_cast<int>(row);
    const int first_column = std::max(middle_column - reach, 0);
    const int last_column = std::min(middle_column + reach, grid.columns - 1);
    for (int y = std::max(middle_row - reach, 0); y <= std::min(middle_row + reach, grid.rows - 1); ++y) {
      const std::int32_t* const in_row = grid.index.data() + static_cast<std::ptrdiff_t>(y) * grid.columns;
      for (int x = first_column; x <= last_column; ++x) {
        if (in_row[x] < 0) continue;
        candidates[count] = grid.points.descriptor(static_cast<std::size_t>(in_row[x]));
        points[count++] = in_row[x];
      }
    }
    const NearestDescriptor nearest = nearest_descriptor(map_.features.descriptor(feature), candidates.data(), count,
                                                         static_cast<std::size_t>(map_.features.descriptor_bytes));
    const Feature& point = grid.points.features[static_cast<std::size_t>(points[nearest.index])];
    const Eigen::Vector2d place(static_cast<double>(point.x_px), static_cast<double>(point.y_px));
    pair.from_pivot_px = place - frame_.pivot_px;
    pair.ground_from_pivot_px = frame_.stretched(pair.from_pivot_px, stretch);
    pair.distance = nearest.distance / bits(map_);
    pair.residual_px = (place - expected).norm();
    return pair;
  }

  /// The frame's point of a pair moved to where its distance would be least.
  Eigen::Vector2d between_points(const GuidedPair& pair) const {
    const Eigen::Vector2d place = pair.from_pivot_px + frame_.pivot_px;
    const int column = static_cast<int>(place.x()) / frame_.grid.step_px;
    const int row = static_cast<int>(place.y()) / frame_.grid.step_px;
    const double middle = pair.distance;
    const double dx = parabola_offset(distance_at(pair, column - 1, row), middle, distance_at(pair, column + 1, row));
    const double dy = parabola_offset(distance_at(pair, column, row - 1), middle, distance_at(pair, column, row + 1));
    return pair.from_pivot_px + frame_.grid.step_px * Eigen::Vector2d(dx, dy);
  }

 private:
  double distance_at(const GuidedPair& pair, int column, int row) const {
    const std::int32_t point = frame_.grid.at(column, row);
    if (point < 0) return pair.distance;
    const std::uint8_t* const descriptor = frame_.grid.points.descriptor(static_cast<std::size_t>(point));
    return nearest_descriptor(map_.features.descriptor(pair.map_feature), &descriptor, 1,
                              static_cast<std::size_t>(map_.features.descriptor_bytes))
               .distance /
           bits(map_);
  }

  const PivotedFrame& frame_;
  const LocalMap& map_;
};

/// Weighted least squares for center, a = scale·cos(yaw), b = scale·sin(yaw), with the prior's turn and scale.
class SimilarityFit {
 public:
  SimilarityFit(const Placement& start, const SearchSpace& space, const BinaryDescriptor& descriptor)
      : start_(start), space_(space), fit_distance_(descriptor.fit_distance), transform_(start) {}

  void add(const GuidedPair& pair) {
    const double nearness = std::max(0.0, 1 - pair.distance / fit_distance_);
    if (nearness <= 0) return;
    const Eigen::Vector2d& o = pair.ground_from_pivot_px;
    const Eigen::Vector2d& m = pair.map_px;
    const double error_px = (m - transform_.map_from_frame(o)).norm();
    const double weight = nearness * nearness / (1 + error_px * error_px / (kFitNoisePx * kFitNoisePx));
    // The sums of weight · Jᵀ J, its lower half, and weight · Jᵀ m for J = (1, 0, x, −y; 0, 1, y, x), spelt out for
    // speed.
    const double wx = weight * o.x();
    const double wy = weight * o.y();
    normal_(0, 0) += weight;
    normal_(1, 1) += weight;
    normal_(2, 0) += wx;
    normal_(2, 1) += wy;
    normal_(3, 0) -= wy;
    normal_(3, 1) += wx;
    normal_(3, 2) += wx * o.y() - wy * o.x();  // what rounding leaves
    normal_(2, 2) += wx * o.x() + wy * o.y();
    normal_(3, 3) += wx * o.x() + wy * o.y();
    right_(0) += weight * m.x();
    right_(1) += weight * m.y();
    right_(2) += wx * m.x() + wy * m.y();
    right_(3) += wx * m.y() - wy * m.x();
    weight_ += nearness * nearness;
    ++pairs_;
  }

  /// The fitted placement, or the start when too few pairs have weight.
  Placement solve() const {
    if (pairs_ < 4) return start_;
    Eigen::Matrix4d normal = normal_;
    Eigen::Vector4d right = right_;
    const double noise_px2 = kFitNoisePx * kFitNoisePx * weight_ / kIndependentPairs;
    const auto add_prior = [&](int row, double value, double sigma) {
      const double information = noise_px2 / (sigma * sigma);
      normal(row, row) += information;
      right(row) += information * value;
    };
    add_prior(2, 1, std::max(space_.scale_sigma, 1e-4));
    add_prior(3, 0, std::max(space_.yaw_sigma_rad, 1e-4));
    const Eigen::Vector4d solution = normal.ldlt().solve(right);
    const Placement placement{solution.head<2>(), std::atan2(solution(3), solution(2)),
                              std::hypot(solution(2), solution(3))};
    if (!solution.allFinite() || !(placement.scale > 0.5 && placement.scale < 2)) return start_;
    return placement;
  }

 private:
  Placement start_;
  SearchSpace space_;
  double fit_distance_;  // farther pairs have no weight
  PlacementTransform transform_;
  Eigen::Matrix4d normal_ = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right_ = Eigen::Vector4d::Zero();
  double weight_ = 0;
  int pairs_ = 0;
};

bool supports(const GuidedPair& pair, const BinaryDescriptor& descriptor) {
  return pair.distance < descriptor.support_distance && pair.residual_px <= kSupportResidualPx;
}

}  // namespace

double GuidedMatch::evidence() const {
  return supporters + kVoteValue * votes;
}

GuidedMatch match_guided(const PivotedFrame& frame, const LocalMap& map, const SearchSpace& space,
                         const Candidate& candidate) {
  const BinaryDescriptor& descriptor = descriptor_of(map.features);
  const GuidedSearch search(frame, map);
  GuidedMatch match;
  match.placement = candidate.placement;
  match.votes = candidate.votes;
  constexpr std::array<int, 3> kReach{kMaxReach, 1, 1};
  for (std::size_t round = 0; round < kReach.size(); ++round) {
    const bool last = round + 1 == kReach.size();
    SimilarityFit fit(match.placement, space, descriptor);
    const PlacementTransform transform(match.placement);
    for (const std::size_t feature : search.features_within(match.placement)) {
      const auto pair = search.find(feature, transform, kReach[round]);
      if (!pair) continue;
      if (last) {
        ++match.expected;
        match.supporters += supports(*pair, descriptor) ? 1 : 0;
      } else {
        fit.add(*pair);
      }
    }
    if (!last) match.placement = fit.solve();
  }
  return match;
}

std::vector<GuidedPair> supporting_pairs(const PivotedFrame& frame, const LocalMap& map, const Placement& placement) {
  const BinaryDescriptor& descriptor = descriptor_of(map.features);
  const GuidedSearch search(frame, map);
  const PlacementTransform transform(placement);
  std::vector<GuidedPair> pairs;
  for (const std::size_t feature : search.features_within(placement)) {
    auto pair = search.find(feature, transform, 1);
    if (!pair || !supports(*pair, descriptor)) continue;
    pair->from_pivot_px = search.between_points(*pair);
    pair->ground_from_pivot_px = frame.stretched(pair->from_pivot_px, map.stretch_of(feature));
    pair->residual_px = (pair->map_px - transform.map_from_frame(pair->ground_from_pivot_px)).norm();
    pairs.push_back(*pair);
  }
  return pairs;
}

}  // namespace pilotage
