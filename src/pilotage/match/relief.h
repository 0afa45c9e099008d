#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "pilotage/camera/ortho_rectify.h"
#include "pilotage/match/ground_heights.h"

namespace pilotage {

struct LocalMap;

/// How the relief of the ground moves what a frame shows, against level ground at the told height below the camera.
///
/// A ray that meets level ground at the offset d from the nadir, h below the camera, meets ground that is z − z₀ higher
/// than the nadir's at d · (1 − (z − z₀)/h). That factor, the stretch, holds for every hypothesis of the place: d is
/// the frame's and z the map's. z₀ is the ground's height at the prior's place. Where the aircraft is elsewhere, z₀ is
/// another, and all offsets are longer or shorter by one factor: an error of scale.
struct Relief {
  GroundHeights ground;        ///< Places are pixels of the level relative to LocalMap::reference_px.
  double height_sigma_m = 0;   ///< Of those heights; 0 where none is known.
  bool is_sparse = false;      ///< Known at fewer than kFewHeights places: what lies between is not.
  double below_m = 0;          ///< z₀.
  double height_agl_m = 1;     ///< h.
  std::vector<float> stretch;  ///< Of each feature of the map; empty, as for level ground: 1 everywhere.
  /// Standard deviation of that error of scale: the root mean square of z − z₀ where the aircraft may be, over h; at
  /// most 0.25.
  double scale_sigma = 0;

  /// Of ground of this height; in [0.3, 3]: a camera above ground that rises by more of its height sees nothing that a
  /// placement could explain.
  double stretch_of_height(double height_m) const;
  /// 1 where no height is known.
  double stretch_at(const Eigen::Vector2d& place_px) const;
};

/// What is believed of the aircraft, as far as relief asks for it.
struct PriorNadir {
  Eigen::Vector2d place_px{0, 0};  ///< Relative to LocalMap::reference_px.
  double sigma_px = 0;             ///< Of the place, along its worst direction.
  double height_agl_m = 1;
};

inline constexpr std::size_t kFewHeights = 20;
/// Of ground between places where its height is known that are fewer. Assumed, not measured.
inline constexpr double kSparseHeightSigma_m = 3;

/// A height of the ground at a place.
struct SpotHeight {
  Eigen::Vector2d place_px{0, 0};  ///< Relative to LocalMap::reference_px.
  double height_m = 0;             ///< NaN where unknown.
};

/// From the heights of the features of `map` and of `below`, the ground about the nadir where the window does not show
/// it (else empty; of any reference_px). Where these are fewer than kFewHeights, from those of landmarks, too. Level
/// where no height is known.
Relief relief_of(const LocalMap& map, const LocalMap& below, const std::vector<SpotHeight>& landmarks,
                 const PriorNadir& nadir);

/// A frame that was laid on level ground, laid on the ground of a place instead: `nadir_px` is the place of its nadir,
/// `px_per_pixel` the pixels of the level along a side of its own. Unchanged where no height is known.
RectifiedFrame laid_over_relief(const RectifiedFrame& level, const Relief& relief, const Eigen::Vector2d& nadir_px,
                                double px_per_pixel);

/// Bytes that laid_over_relief takes at most for a frame of this side.
double relief_frame_bytes(double side_px);

}  // namespace pilotage
