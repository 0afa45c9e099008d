#pragma once

#include <vector>

#include <Eigen/Core>

#include "pilotage/match/frame_grid.h"
#include "pilotage/match/local_map.h"

namespace pilotage {

// Positions in this file are pixels of the map's level relative to LocalMap::reference_px, x right, y down. A frame is
// placed on the map by a similarity about the frame's pivot, the ground under the camera's principal point:
//   place on the map = center_px + scale · R(yaw) · (pixel of the frame − pivot)
// with R turning clockwise by yaw, as headings do.

/// A frame on the map.
struct Placement {
  Eigen::Vector2d center_px{0, 0};
  double yaw_rad = 0;  ///< Against the prior yaw.
  double scale = 1;

  Eigen::Vector2d map_from_frame(const Eigen::Vector2d& from_pivot_px) const;
  Eigen::Vector2d frame_from_map(const Eigen::Vector2d& map_px) const;
};

/// A frame that has been described, and the pixel that it is turned about.
struct PivotedFrame {
  FrameGrid grid;
  Eigen::Vector2d pivot_px{0, 0};
  double radius_px = 0;  ///< Largest distance of a described point from the pivot.
};

/// What is searched: all places whose centre lies in a square, and all turns and scales the prior allows.
struct SearchSpace {
  Eigen::Vector2d center_px{0, 0};
  double half_width_px = 0;
  double yaw_sigma_rad = 0;
  double scale_sigma = 0;
  bool oriented = false;  ///< Descriptors turn with the patch: a pair votes only for the turn that its angles tell.
};

/// A place with many votes.
struct Candidate {
  Placement placement;
  double votes = 0;
};

/// Displacement voting: each feature of the map is paired with the kVoteNeighbours nearest descriptors of the frame
/// among those that would put the frame inside the search square, nearer than kVoteDistance of the bits; each pair adds
/// (1 − distance/limit)² to a two-dimensional histogram of centres, one for each turn and scale on a grid fine enough
/// that no pair moves by more than kVoteStepPx between neighbours. Histograms are smoothed (Gaussian, one bin); the
/// highest `count` peaks that are kPeakSeparationPx apart are returned, most votes first. Cf. D. H. Ballard,
/// "Generalizing the Hough transform", Pattern Recognition 13(2), 1981.
std::vector<Candidate> vote_for_displacements(const PivotedFrame& frame, const LocalMap& map, const SearchSpace& space,
                                              std::size_t count);

inline constexpr int kVoteNeighbours = 4;
inline constexpr double kVoteDistance = 90.0 / 256;
inline constexpr double kVoteStepPx = 2.5;
inline constexpr double kVoteBinPx = 2;
inline constexpr double kPeakSeparationPx = 6;
/// Above this standard deviation of yaw the whole circle is searched.
inline constexpr double kUnknownYawRad = 1.0;

}  // namespace pilotage
