#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pilotage/geo/geodetic_point.h"
#include "pilotage/geo/local_frame.h"
#include "pilotage/mapdb/map_reader.h"
#include "pilotage/match/checkpoint.h"
#include "pilotage/match/relief.h"
#include "pilotage/vision/feature_set.h"

namespace pilotage {

/// Where a piece of a level's pixel grid lies on the ground: an affine map between pixels and the WGS 84 tangent plane
/// at `frame`'s origin, taken from the nearest tile (MapTile::enu_from_grid has its error), or plain_grid().
struct LocalGrid {
  LocalFrame frame{{0, 0}};
  Eigen::Vector2d origin_px{0, 0};                            ///< The frame's origin, in pixels of the level.
  Eigen::Matrix2d enu_from_px = Eigen::Matrix2d::Identity();  ///< East, north in metres per pixel right, down.

  bool is_of_level = true;  ///< Else its pixels are not those of the level: features and chips have no place on it.

  double gsd_m() const;            ///< Ground length of a pixel.
  double convergence_deg() const;  ///< Azimuth of "up" in the grid: what true north must be turned by.
  Eigen::Vector2d px_from_enu(const Eigen::Vector2d& enu_m) const;
  Eigen::Vector2d px_from_geodetic(const GeodeticPoint& point) const;
  GeodeticPoint geodetic_from_px(const Eigen::Vector2d& position_px) const;
};

/// The map's features around a place.
struct LocalMap {
  int level = 0;
  LocalGrid grid;
  FeatureSet features;                                          ///< x_px, y_px relative to `reference_px`.
  double features_per_mpx = FeatureOptions().features_per_mpx;  ///< For which the map was built.
  Eigen::Vector2d reference_px{0, 0};  ///< A whole pixel of the level, so that floats keep 1/16 px.
  std::vector<float> ground_height_m;  ///< One for each feature, NaN where unknown; empty when no height is known.
  std::vector<std::int64_t> tile_ids;  ///< Of each feature.

  Relief relief;  ///< Level until relief_of() is asked.

  double stretch_of(std::size_t feature) const {
    return relief.stretch.empty() ? 1 : static_cast<double>(relief.stretch[feature]);
  }
};

/// The level that serves `height_agl_m` (the band it lies in, else the nearest), or nothing when the map has none.
const MapLevel* level_for_height(const MapReader& map, double height_agl_m);

/// The grid of `level` about `point`, or nothing when the level has no tile within `radius_m`. Throws DataError when
/// the map is damaged, UsageError when the point is not on Earth.
std::optional<LocalGrid> local_grid(MapReader& map, const MapLevel& level, GeodeticPoint point, double radius_m);

/// A grid where a level has no tile: north up about `point`, where pixel (0, 0) begins, with pixels as wide as the
/// level's. Exact on the tangent plane.
LocalGrid plain_grid(const MapLevel& level, GeodeticPoint point);

/// The features of `level` in the square of half side `half_width_px` about `center_px`; reading ends with the tile
/// that makes them more than `max_features`. None on a plain_grid(). Throws DataError when the map is damaged here or
/// its tiles differ in descriptor length.
LocalMap read_local_map(MapReader& map, const MapLevel& level, const LocalGrid& grid, const Eigen::Vector2d& center_px,
                        double half_width_px, std::size_t max_features = std::numeric_limits<std::size_t>::max(),
                        const Checkpoint& checkpoint = {});

}  // namespace pilotage
