#include "pilotage/match/local_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include <Eigen/LU>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

/// Distance of a height from the band of a level, as a ratio; 0 inside.
double band_distance(const MapLevel& level, double height_agl_m) {
  if (height_agl_m < level.min_agl_m) return std::log(level.min_agl_m / height_agl_m);
  if (height_agl_m > level.max_agl_m) return std::log(height_agl_m / std::max(level.max_agl_m, 1e-3));
  return 0;
}

}  // namespace

double LocalGrid::gsd_m() const {
  return std::sqrt(std::abs(enu_from_px.determinant()));
}

double LocalGrid::convergence_deg() const {
  const Eigen::Vector2d up = enu_from_px * Eigen::Vector2d(0, -1);
  return std::atan2(up.x(), up.y()) * 180 / std::numbers::pi;
}

Eigen::Vector2d LocalGrid::px_from_enu(const Eigen::Vector2d& enu_m) const {
  return origin_px + enu_from_px.inverse() * enu_m;
}

Eigen::Vector2d LocalGrid::px_from_geodetic(const GeodeticPoint& point) const {
  return px_from_enu(frame.enu_from_geodetic(point).head<2>());
}

GeodeticPoint LocalGrid::geodetic_from_px(const Eigen::Vector2d& position_px) const {
  const Eigen::Vector2d enu_m = enu_from_px * (position_px - origin_px);
  return frame.geodetic_from_enu({enu_m.x(), enu_m.y(), 0});
}

const MapLevel* level_for_height(const MapReader& map, double height_agl_m) {
  const MapLevel* best = nullptr;
  for (const MapLevel& level : map.levels()) {
    if (best == nullptr || band_distance(level, height_agl_m) < band_distance(*best, height_agl_m)) best = &level;
  }
  return best;
}

std::optional<LocalGrid> local_grid(MapReader& map, const MapLevel& level, GeodeticPoint point, double radius_m) {
  const auto near = map.tiles_near(point, radius_m, level.matrix.level);
  if (near.empty()) return std::nullopt;
  const MapTile& tile = near.front().tile;
  const GeoTransform& map_from_pixel = level.matrix.map_from_pixel;
  Eigen::Matrix2d grid_from_px;
  grid_from_px << map_from_pixel.x_per_col, map_from_pixel.x_per_row, map_from_pixel.y_per_col,
      map_from_pixel.y_per_row;
  LocalGrid grid;
  grid.frame = LocalFrame(tile.center);
  grid.origin_px = map_from_pixel.pixel_from_map(tile.bounds.center_m());
  grid.enu_from_px = tile.enu_from_grid * grid_from_px;
  if (!(grid.gsd_m() > 0) || !std::isfinite(grid.gsd_m())) {
    throw DataError("tile " + std::to_string(tile.tile_id) + ": its grid has no finite scale above 0 on the ground");
  }
  return grid;
}

LocalGrid plain_grid(const MapLevel& level, GeodeticPoint point) {
  LocalGrid grid;
  grid.is_of_level = false;
  grid.frame = LocalFrame(point);
  grid.enu_from_px << level.gsd_m, 0, 0, -level.gsd_m;
  return grid;
}

LocalMap read_local_map(MapReader& map, const MapLevel& level, const LocalGrid& grid, const Eigen::Vector2d& center_px,
                        double half_width_px, std::size_t max_features, const Checkpoint& checkpoint) {
  LocalMap local;
  local.level = level.matrix.level;
  local.grid = grid;
  local.features_per_mpx = map.features().features_per_mpx;
  local.features.pattern = map.features().pattern;
  local.features.descriptor_bytes = map.features().descriptor_bits / 8;
  local.reference_px = {std::floor(center_px.x()), std::floor(center_px.y())};
  if (!grid.is_of_level) return local;
  const double radius_m = half_width_px * std::numbers::sqrt2 * grid.gsd_m();
  bool first = true;
  for (const NearTile& near : map.tiles_near(grid.geodetic_from_px(center_px), std::min(radius_m, 1e5), local.level)) {
    if (local.features.size() > max_features) break;
    pass(checkpoint);
    const auto stored = map.descriptors(near.tile.tile_id, local.level);
    if (!stored || stored->features.size() == 0) continue;
    if (first) {
      local.features.pattern = stored->features.pattern;
      local.features.descriptor_bytes = stored->features.descriptor_bytes;
    }
    if (stored->features.descriptor_bytes != local.features.descriptor_bytes) {
      throw DataError("tile " + std::to_string(near.tile.tile_id) + ": descriptors of " +
                      std::to_string(stored->features.descriptor_bytes) + " bytes, its neighbours have " +
                      std::to_string(local.features.descriptor_bytes));
    }
    first = false;
    const Eigen::Vector2d shift(static_cast<double>(stored->window.col) - local.reference_px.x(),
                                static_cast<double>(stored->window.row) - local.reference_px.y());
    const Eigen::Vector2d offset = center_px - local.reference_px;
    for (std::size_t i = 0; i < stored->features.size(); ++i) {
      Feature feature = stored->features.features[i];
      const Eigen::Vector2d place =
          shift + Eigen::Vector2d(static_cast<double>(feature.x_px), static_cast<double>(feature.y_px));
      if ((place - offset).cwiseAbs().maxCoeff() > half_width_px) continue;
      feature.x_px = static_cast<float>(place.x());
      feature.y_px = static_cast<float>(place.y());
      local.features.features.push_back(feature);
      const std::uint8_t* const descriptor = stored->features.descriptor(i);
      local.features.descriptors.insert(local.features.descriptors.end(), descriptor,
                                        descriptor + stored->features.descriptor_bytes);
      local.tile_ids.push_back(near.tile.tile_id);
      local.ground_height_m.push_back(stored->ground_height_m.empty() ? std::numeric_limits<float>::quiet_NaN()
                                                                      : stored->ground_height_m[i]);
    }
  }
  return local;
}

}  // namespace pilotage
