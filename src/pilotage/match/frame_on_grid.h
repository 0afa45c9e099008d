#pragma once

#include <optional>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pilotage/base/angle.h"
#include "pilotage/match/displacement_voting.h"
#include "pilotage/match/local_map.h"
#include "pilotage/match/match.h"

namespace pilotage {

/// Largest side of a rectified frame: about 0.5 km at 0.6 m/px. More adds time, not certainty.
inline constexpr int kMaxRectifiedSidePx = 768;

/// Of the search square: beyond it neither places nor chips are counted in what a search is meant to take.
inline constexpr double kMaxHalfWidthPx = 4096;

/// A frame rectified onto the grid of a level of the map, and where the prior puts it.
struct FrameOnGrid {
  std::optional<MatchStatus> refusal;  ///< Why the frame cannot be matched; the rest may not be filled then.
  const MapLevel* level = nullptr;
  LocalGrid grid;
  RectifiedFrame frame;
  Eigen::Vector2d pivot_m{0, 0};   ///< Ground under the principal point, from the nadir, right and up.
  Eigen::Vector2d prior_px{0, 0};  ///< Of the aircraft, in pixels of the level.
  double half_width_px = 0;
  double gsd_m = 1;

  /// From metres right and up to pixels right and down, and back; lengths only.
  Eigen::Vector2d px_from_m(const Eigen::Vector2d& m) const { return {m.x() / gsd_m, -m.y() / gsd_m}; }
  Eigen::Vector2d m_from_px(const Eigen::Vector2d& px) const { return {px.x() * gsd_m, -px.y() * gsd_m}; }
  Eigen::Matrix2d enu_from_grid_m() const {
    Eigen::Matrix2d px_per_m;
    px_per_m << 1 / gsd_m, 0, 0, -1 / gsd_m;
    return grid.enu_from_px * px_per_m;
  }
};

/// Half side of the searched square: the square about the prior's error ellipse of search_sigmas, and what the tilt's
/// error moves the principal point by.
double search_half_width_m(const MatchPrior& prior, const MatchOptions& options);

/// The attitude against the grid's up instead of true north.
Attitude attitude_on_grid(const Attitude& attitude, const LocalGrid& grid);

/// Rectifies `frame` onto the grid of the level that serves its height, or onto plain_grid() where a landmark lies
/// about the prior and no tile. The refusal says why it cannot be: the map has nothing here, the window is larger than
/// kMaxHalfWidthPx, or the frame cannot be rectified. Throws DataError when the map is damaged.
FrameOnGrid rectify_frame(const cv::Mat& frame, const MatchPrior& prior, const Camera& camera, MapReader& map,
                          const MatchOptions& options, const Checkpoint& checkpoint = {});

/// The frame described on its usual grid, to be turned about the ground under the principal point.
PivotedFrame describe(const FrameOnGrid& rectified, const FeatureOptions& options, const Checkpoint& checkpoint = {});

/// The same of a grid that describes the frame already.
PivotedFrame pivoted_frame(const FrameOnGrid& rectified, FrameGrid grid);

/// What is searched on `map`.
SearchSpace search_space(const FrameOnGrid& rectified, const LocalMap& map, const MatchOptions& options);

}  // namespace pilotage
