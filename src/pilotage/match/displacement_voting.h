#pragma once

#include <vector>

#include <Eigen/Core>

#include "pilotage/match/checkpoint.h"
#include "pilotage/match/frame_grid.h"
#include "pilotage/match/local_map.h"
#include "pilotage/match/vote_peaks.h"

namespace pilotage {

/// A frame that has been described, and the pixel that it is turned about.
struct PivotedFrame {
  FrameGrid grid;
  Eigen::Vector2d pivot_px{0, 0};
  Eigen::Vector2d nadir_px{0, 0};  ///< The point straight below the camera.
  double radius_px = 0;            ///< Largest distance of a described point from the pivot.

  /// A place, from the pivot, moved away from the nadir: `stretch` times as far off.
  Eigen::Vector2d stretched(const Eigen::Vector2d& from_pivot_px, double stretch) const {
    const Eigen::Vector2d nadir_from_pivot_px = nadir_px - pivot_px;
    return nadir_from_pivot_px + stretch * (from_pivot_px - nadir_from_pivot_px);
  }
};

/// What is searched: all places whose centre lies in a square, and all turns and scales the prior allows.
struct SearchSpace {
  Eigen::Vector2d center_px{0, 0};
  double half_width_px = 0;
  double yaw_sigma_rad = 0;
  double scale_sigma = 0;
};

/// Displacement voting: each feature of the map is paired with the kVoteNeighbours nearest descriptors of the frame
/// among those that would put the frame inside the search square, nearer than BinaryDescriptor::vote_distance; each
/// pair adds (1 − distance/limit)² to a two-dimensional histogram of centres, one for each turn and scale on a grid
/// fine enough that no pair moves by more than kVoteStepPx between neighbours (on level ground; over relief by
/// Relief::stretch as much). A pair's point of the frame is taken where its ray meets ground as high as the map's
/// feature, so all pairs of a place agree over relief, too. The highest `count` peaks are returned (vote_peaks.h). Cf.
/// D. H. Ballard, "Generalizing the Hough transform", Pattern Recognition 13(2), 1981.
///
/// Where that takes more than kVotingComparisons of descriptors, every second, third … feature of the map votes, as
/// long as the frame has kVotingPoints points for each of them: a large frame shows more features than voting needs. Of
/// all pairs the nearest kLeastVotePairs vote, or kVotePairsPerPx2 for each pixel of the square.
std::vector<Candidate> vote_for_displacements(const PivotedFrame& frame, const LocalMap& map, const SearchSpace& space,
                                              std::size_t count, const Checkpoint& checkpoint = {});

/// The pairs that vote, of every `stride`-th feature of the map at most, as many as are said above.
std::vector<VotePair> vote_pairs(const PivotedFrame& frame, const LocalMap& map, const SearchSpace& space,
                                 const Checkpoint& checkpoint = {}, std::size_t stride = 1);

/// Number of comparisons of descriptors that voting makes at most with `map_features`.
double vote_comparisons(const PivotedFrame& frame, std::size_t map_features);

/// Number of histogram bins over all turns and scales.
double search_bins(const PivotedFrame& frame, const SearchSpace& space);

inline constexpr int kVoteNeighbours = 4;
inline constexpr double kVoteStepPx = 2.5;
inline constexpr double kVotingComparisons = 2e9;
inline constexpr double kVotingPoints = 16384;
/// Of the pairs the nearest vote: at least so many, and more where the window is wider than that of the calibration.
inline constexpr double kLeastVotePairs = 4000;
inline constexpr double kVotePairsPerPx2 = 0.04;

}  // namespace pilotage
