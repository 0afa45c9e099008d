#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "pilotage/match/displacement_voting.h"

namespace pilotage {

/// A feature of the map and the point of the frame that matches it best near where a placement expects it.
struct GuidedPair {
  std::size_t map_feature = 0;
  Eigen::Vector2d from_pivot_px{0, 0};  ///< The frame's point, to a fraction of a grid step.
  /// Where its ray meets ground as high as the feature's: what the similarity of a placement puts on the map.
  Eigen::Vector2d ground_from_pivot_px{0, 0};
  Eigen::Vector2d map_px{0, 0};
  double distance = 0;     ///< Share of differing bits.
  double residual_px = 0;  ///< Between the point's place on the map and the feature.
};

/// How well a frame fits at one place.
struct GuidedMatch {
  Placement placement;  ///< Refined.
  double votes = 0;     ///< Of the candidate it started from.
  int expected = 0;     ///< Features of the map that the frame should show there.
  int supporters = 0;   ///< Of these, found within BinaryDescriptor::support_distance and kSupportResidualPx.
  /// What candidates are ranked by: supporters + kVoteValue · votes.
  double evidence() const;
};

inline constexpr double kSupportResidualPx = 1.6;
inline constexpr double kVoteValue = 10;

/// Looks for every map feature that lies inside the frame, under a candidate's placement, among the frame's points
/// around its expected place (that of its own height: Relief::stretch), and fits turn, scale and centre to the pairs
/// by weighted least squares with the prior of `space`; three rounds, with a smaller neighbourhood after the first.
/// Unlike votes this needs no descriptor to be among the nearest of the whole window. One answer for each candidate.
std::vector<GuidedMatch> match_guided(const PivotedFrame& frame, const LocalMap& map, const SearchSpace& space,
                                      std::span<const Candidate> candidates, const Checkpoint& checkpoint = {});

/// The supporters of a placement.
std::vector<GuidedPair> supporting_pairs(const PivotedFrame& frame, const LocalMap& map, const Placement& placement);

}  // namespace pilotage
