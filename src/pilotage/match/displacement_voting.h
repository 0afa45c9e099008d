#pragma once

#include <cmath>
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

/// A placement's two functions for many points: the sine and cosine are at hand, the numbers are the same to the bit.
class PlacementTransform {
 public:
  explicit PlacementTransform(const Placement& placement)
      : center_px_(placement.center_px),
        scale_(placement.scale),
        cosine_(std::cos(placement.yaw_rad)),
        sine_(std::sin(placement.yaw_rad)),
        scaled_cosine_(scale_ * cosine_),
        scaled_sine_(scale_ * sine_) {}

  Eigen::Vector2d map_from_frame(const Eigen::Vector2d& from_pivot_px) const {
    return center_px_ + Eigen::Vector2d(scaled_cosine_ * from_pivot_px.x() - scaled_sine_ * from_pivot_px.y(),
                                        scaled_sine_ * from_pivot_px.x() + scaled_cosine_ * from_pivot_px.y());
  }
  Eigen::Vector2d frame_from_map(const Eigen::Vector2d& map_px) const {
    const Eigen::Vector2d d = (map_px - center_px_) / scale_;
    return {cosine_ * d.x() + sine_ * d.y(), -sine_ * d.x() + cosine_ * d.y()};
  }

 private:
  Eigen::Vector2d center_px_;
  double scale_;
  double cosine_;
  double sine_;
  double scaled_cosine_;
  double scaled_sine_;
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
  bool oriented = false;  ///< Descriptors turn with the patch: a pair votes only for the turn between its angles.
};

/// A place with many votes.
struct Candidate {
  Placement placement;
  double votes = 0;
};

/// Displacement voting: each feature of the map is paired with the kVoteNeighbours nearest descriptors of the frame
/// among those that would put the frame inside the search square, nearer than BinaryDescriptor::vote_distance; each
/// pair adds (1 − distance/limit)² to a two-dimensional histogram of centres, one for each turn and scale on a grid
/// fine enough that no pair moves by more than kVoteStepPx between neighbours. Histograms are smoothed (Gaussian, one
/// bin); the highest `count` peaks that are kPeakSeparationPx apart are returned, most votes first. Cf. D. H. Ballard,
/// "Generalizing the Hough transform", Pattern Recognition 13(2), 1981.
std::vector<Candidate> vote_for_displacements(const PivotedFrame& frame, const LocalMap& map, const SearchSpace& space,
                                              std::size_t count);

/// Number of histogram bins over all turns and scales: what voting costs, some 10 ns each.
double search_bins(const PivotedFrame& frame, const SearchSpace& space);

inline constexpr int kVoteNeighbours = 4;
inline constexpr double kVoteStepPx = 2.5;
inline constexpr double kVoteBinPx = 2;
inline constexpr double kPeakSeparationPx = 6;
/// Above this standard deviation of yaw the whole circle is searched.
inline constexpr double kUnknownYawRad = 1.0;

}  // namespace pilotage
