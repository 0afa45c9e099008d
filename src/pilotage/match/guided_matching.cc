#include "pilotage/match/guided_matching.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>

#include "pilotage/base/wide_clones.h"
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

/// Where the features of a map lie, in groups of kTogether; the last one is filled up.
struct MapPlaces {
  std::vector<double> x_px;
  std::vector<double> y_px;
  std::vector<double> shrink;  // 1 / Relief::stretch

  explicit MapPlaces(const LocalMap& map) {
    const std::size_t groups = (map.features.size() + kTogether - 1) / kTogether;
    for (std::vector<double>* const numbers : {&x_px, &y_px, &shrink}) numbers->resize(groups * kTogether);
    for (std::size_t i = 0; i < map.features.size(); ++i) {
      x_px[i] = static_cast<double>(map.features.features[i].x_px);
      y_px[i] = static_cast<double>(map.features.features[i].y_px);
      shrink[i] = 1 / map.stretch_of(i);
    }
  }
};

/// Where features are expected in the frame.
struct ExpectedPlaces {
  Together x_px;
  Together y_px;
  Together column;  // of the frame's grid; its whole part is the nearest point's
  Together row;
  Together inside;  // the frame's grid, if above 0: its least distance from an edge
};

/// What Placement::frame_from_map() and PivotedFrame::stretched() take, as plain numbers.
struct Expectation {
  double center_x_px;
  double center_y_px;
  double scale;
  double cosine;
  double sine;
  double nadir_x_px;  // from the pivot
  double nadir_y_px;
  double pivot_x_px;
  double pivot_y_px;
  double per_step;  // exact for steps of two pixels
  double columns;
  double rows;

  Expectation(const PivotedFrame& frame, const Placement& placement)
      : center_x_px(placement.center_px.x()),
        center_y_px(placement.center_px.y()),
        scale(placement.scale),
        cosine(std::cos(placement.yaw_rad)),
        sine(std::sin(placement.yaw_rad)),
        nadir_x_px(frame.nadir_px.x() - frame.pivot_px.x()),
        nadir_y_px(frame.nadir_px.y() - frame.pivot_px.y()),
        pivot_x_px(frame.pivot_px.x()),
        pivot_y_px(frame.pivot_px.y()),
        per_step(1.0 / frame.grid.step_px),
        columns(frame.grid.columns),
        rows(frame.grid.rows) {}
};

/// Of kTogether features.
PILOTAGE_WIDE_CLONES
void expect_features(const double* map_x_px, const double* map_y_px, const double* shrink, const Expectation& under,
                     ExpectedPlaces& places) {
  const Expectation by = under;
  Together x;
  Together y;
  for (std::size_t i = 0; i < kTogether; ++i) {
    const double right = (map_x_px[i] - by.center_x_px) / by.scale;
    const double down = (map_y_px[i] - by.center_y_px) / by.scale;
    const double frame_x = by.cosine * right + by.sine * down;
    const double frame_y = -by.sine * right + by.cosine * down;
    x[i] = by.nadir_x_px + shrink[i] * (frame_x - by.nadir_x_px) + by.pivot_x_px;
    y[i] = by.nadir_y_px + shrink[i] * (frame_y - by.nadir_y_px) + by.pivot_y_px;
  }
  Together column;
  Together row;
  Together inside;
  for (std::size_t i = 0; i < kTogether; ++i) {
    column[i] = (x[i] - 0.5) * by.per_step + 0.5;
    row[i] = (y[i] - 0.5) * by.per_step + 0.5;
    const double beside = std::min(column[i], by.columns - column[i]);
    const double above = std::min(row[i], by.rows - row[i]);
    inside[i] = std::min(beside, above);
  }
  places.x_px = x;
  places.y_px = y;
  places.column = column;
  places.row = row;
  places.inside = inside;
}

/// A feature of the map that the frame should show, and the nearest point of the frame around its expected place.
struct SeenFeature {
  std::size_t map_feature;
  Eigen::Vector2d expected_px;  // in the frame
  std::size_t point;            // of the frame's grid
  std::uint32_t distance_bits;
};

class GuidedSearch {
 public:
  GuidedSearch(const PivotedFrame& frame, const LocalMap& map)
      : frame_(frame), map_(map), places_(map), nearest_(map.features.size()) {}

  /// Calls act(SeenFeature) for every feature of the map, in their order, that has a point of the frame at its expected
  /// place. Compared are the points within `reach` grid steps of that.
  template <typename Act>
  void for_seen_features(const Placement& placement, int reach, const Act& act) {
    const FrameGrid& grid = frame_.grid;
    const Expectation under(frame_, placement);
    ExpectedPlaces places;
    for (std::size_t first = 0; first < map_.features.size(); first += kTogether) {
      expect_features(&places_.x_px[first], &places_.y_px[first], &places_.shrink[first], under, places);
      const std::size_t count = std::min(kTogether, map_.features.size() - first);
      for (std::size_t i = 0; i < count; ++i) {
        if (!(places.inside[i] > 0)) continue;
        const GridCell cell{static_cast<int>(places.column[i]), static_cast<int>(places.row[i])};
        if (grid.at(cell.column, cell.row) < 0) continue;
        const NearestPoint& nearest = nearest_point(first + i, cell, reach);
        act(SeenFeature{first + i,
                        {places.x_px[i], places.y_px[i]},
                        static_cast<std::size_t>(grid.at(nearest.at.column, nearest.at.row)),
                        nearest.distance_bits});
      }
    }
  }

  double distance(const SeenFeature& seen) const { return seen.distance_bits / bits(map_); }

  double residual_px(const SeenFeature& seen) const { return (place(seen.point) - seen.expected_px).norm(); }

  GuidedPair pair(const SeenFeature& seen) const {
    const Feature& of_map = map_.features.features[seen.map_feature];
    GuidedPair pair;
    pair.map_feature = seen.map_feature;
    pair.map_px = {static_cast<double>(of_map.x_px), static_cast<double>(of_map.y_px)};
    pair.from_pivot_px = place(seen.point) - frame_.pivot_px;
    pair.ground_from_pivot_px = frame_.stretched(pair.from_pivot_px, map_.stretch_of(seen.map_feature));
    pair.distance = distance(seen);
    pair.residual_px = residual_px(seen);
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
  struct GridCell {
    int column;
    int row;
    bool operator==(const GridCell&) const = default;
  };

  struct NearestPoint {
    GridCell about{-1, -1};  // searched last
    int reach = 0;           // likewise
    GridCell at{-1, -1};
    std::uint32_t distance_bits = 0;
  };

  /// The point with the nearest descriptor, the first of equal ones, within `reach` steps of a cell. Rounds and
  /// neighbouring candidates move most features by less than a step: what was found about the same cell, by a wider
  /// search too if it lies within reach, is found again.
  const NearestPoint& nearest_point(std::size_t feature, const GridCell& about, int reach) {
    NearestPoint& nearest = nearest_[feature];
    const bool is_known = nearest.about == about && nearest.reach >= reach &&
                          std::abs(nearest.at.column - about.column) <= reach &&
                          std::abs(nearest.at.row - about.row) <= reach;
    if (!is_known) nearest = search(feature, about, reach);
    return nearest;
  }

  NearestPoint search(std::size_t feature, const GridCell& about, int reach) const {
    constexpr std::size_t kMostPoints = (2 * kMaxReach + 1) * (2 * kMaxReach + 1);
    const FrameGrid& grid = frame_.grid;
    std::array<const std::uint8_t*, kMostPoints> candidates;
    std::array<GridCell, kMostPoints> cells;
    std::size_t count = 0;
    const int first_column = std::max(about.column - reach, 0);
    const int last_column = std::min(about.column + reach, grid.columns - 1);
    for (int y = std::max(about.row - reach, 0); y <= std::min(about.row + reach, grid.rows - 1); ++y) {
      const std::int32_t* const in_row = grid.index.data() + static_cast<std::ptrdiff_t>(y) * grid.columns;
      for (int x = first_column; x <= last_column; ++x) {
        if (in_row[x] < 0) continue;
        candidates[count] = grid.points.descriptor(static_cast<std::size_t>(in_row[x]));
        cells[count++] = {x, y};
      }
    }
    const NearestDescriptor nearest = nearest_descriptor(map_.features.descriptor(feature), candidates.data(), count,
                                                         static_cast<std::size_t>(map_.features.descriptor_bytes));
    return {about, reach, cells[nearest.index], nearest.distance};
  }

  /// Of a point of the grid, in the frame.
  Eigen::Vector2d place(std::size_t point) const {
    const Feature& of_frame = frame_.grid.points.features[point];
    return {static_cast<double>(of_frame.x_px), static_cast<double>(of_frame.y_px)};
  }

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
  MapPlaces places_;
  std::vector<NearestPoint> nearest_;  // of each feature of the map
};

/// Weighted least squares for center, a = scale·cos(yaw), b = scale·sin(yaw), with the prior's turn and scale.
class SimilarityFit {
 public:
  SimilarityFit(const Placement& start, const SearchSpace& space, const BinaryDescriptor& descriptor)
      : start_(start), space_(space), fit_distance_(descriptor.fit_distance), transform_(start) {}

  /// A pair nearer than BinaryDescriptor::fit_distance: others have no weight.
  void add(const GuidedPair& pair) {
    const double nearness = 1 - pair.distance / fit_distance_;
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
  double fit_distance_;
  PlacementTransform transform_;
  Eigen::Matrix4d normal_ = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right_ = Eigen::Vector4d::Zero();
  double weight_ = 0;
  int pairs_ = 0;
};

/// Whether what was seen of a feature speaks for the placement that it was expected under.
bool supports(const GuidedSearch& search, const SeenFeature& seen, const BinaryDescriptor& descriptor) {
  return search.distance(seen) < descriptor.support_distance && search.residual_px(seen) <= kSupportResidualPx;
}

}  // namespace

double GuidedMatch::evidence() const {
  return supporters + kVoteValue * votes;
}

std::vector<GuidedMatch> match_guided(const PivotedFrame& frame, const LocalMap& map, const SearchSpace& space,
                                      std::span<const Candidate> candidates, const Checkpoint& checkpoint) {
  if (candidates.empty()) return {};
  const BinaryDescriptor& descriptor = descriptor_of(map.features);
  GuidedSearch search(frame, map);
  std::vector<GuidedMatch> matches;
  for (const Candidate& candidate : candidates) {
    pass(checkpoint);
    GuidedMatch& match = matches.emplace_back();
    match.placement = candidate.placement;
    match.votes = candidate.votes;
    for (const int reach : {kMaxReach, 1}) {
      SimilarityFit fit(match.placement, space, descriptor);
      search.for_seen_features(match.placement, reach, [&](const SeenFeature& seen) {
        if (search.distance(seen) < descriptor.fit_distance) fit.add(search.pair(seen));
      });
      match.placement = fit.solve();
    }
    search.for_seen_features(match.placement, 1, [&](const SeenFeature& seen) {
      ++match.expected;
      match.supporters += supports(search, seen, descriptor) ? 1 : 0;
    });
  }
  return matches;
}

std::vector<GuidedPair> supporting_pairs(const PivotedFrame& frame, const LocalMap& map, const Placement& placement) {
  const BinaryDescriptor& descriptor = descriptor_of(map.features);
  GuidedSearch search(frame, map);
  const PlacementTransform transform(placement);
  std::vector<GuidedPair> pairs;
  search.for_seen_features(placement, 1, [&](const SeenFeature& seen) {
    if (!supports(search, seen, descriptor)) return;
    GuidedPair pair = search.pair(seen);
    pair.from_pivot_px = search.between_points(pair);
    pair.ground_from_pivot_px = frame.stretched(pair.from_pivot_px, map.stretch_of(pair.map_feature));
    pair.residual_px = (pair.map_px - transform.map_from_frame(pair.ground_from_pivot_px)).norm();
    pairs.push_back(pair);
  });
  return pairs;
}

}  // namespace pilotage
