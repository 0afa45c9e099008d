#include "pilotage/mapdb/map_tables.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/LU>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

constexpr int kMinInt = std::numeric_limits<int>::min();
constexpr int kMaxInt = std::numeric_limits<int>::max();
// Wider than the Earth: what lies outside was never written.
constexpr double kMaxCoordinate_m = 1e8;
constexpr double kMaxTileRadius_m = 1e6;

bool sane(double coordinate_m) {
  return std::abs(coordinate_m) <= kMaxCoordinate_m;
}

}  // namespace

std::string tile_problem(const MapTile& tile) {
  const Bounds& b = tile.bounds;
  if (!(sane(b.min_x_m) && sane(b.min_y_m) && sane(b.max_x_m) && sane(b.max_y_m) && b.width_m() > 0 &&
        b.height_m() > 0)) {
    return "bounds (" + format_number(b.min_x_m) + ", " + format_number(b.min_y_m) + ", " + format_number(b.max_x_m) +
           ", " + format_number(b.max_y_m) + ") enclose no area on Earth";
  }
  if (!(std::abs(tile.center.lon_deg) <= 180 && std::abs(tile.center.lat_deg) <= 90)) {
    return "centre (lon " + format_number(tile.center.lon_deg) + ", lat " + format_number(tile.center.lat_deg) +
           ") is not on Earth";
  }
  // No grid that is good for measuring stretches by ten or squeezes by ten; determinant and norm bound both.
  const Eigen::Matrix2d& m = tile.enu_from_grid;
  if (!(m.allFinite() && m.determinant() >= 0.01 && m.norm() <= 20)) {
    return "matrix east_per_x … north_per_y (" + format_number(m(0, 0)) + ", " + format_number(m(0, 1)) + ", " +
           format_number(m(1, 0)) + ", " + format_number(m(1, 1)) + ") is not that of a map projection in metres";
  }
  if (!(tile_radius_m(tile) <= kMaxTileRadius_m)) {
    return "is larger than " + format_number(kMaxTileRadius_m) + " m";
  }
  return {};
}

MapTile read_tile_row(const Statement& statement, const std::string& file) {
  MapTile tile;
  tile.tile_id = statement.integer(0);
  const std::string where = file + ": tile " + std::to_string(tile.tile_id);
  tile.level = statement.integer(1, kMinInt, kMaxInt);
  tile.column = statement.integer(2);
  tile.row = statement.integer(3);
  tile.bounds = {statement.real(4), statement.real(5), statement.real(6), statement.real(7)};
  tile.center = {statement.real(8), statement.real(9)};
  // Not by Eigen's comma: it asserts when an exception interrupts it.
  for (int i = 0; i < 4; ++i) tile.enu_from_grid(i / 2, i % 2) = statement.real(10 + i);
  const std::string problem = tile_problem(tile);
  if (!problem.empty()) throw DataError(where + ": " + problem);
  return tile;
}

std::string level_problem(const MapLevel& level) {
  const TileMatrix& m = level.matrix;
  const GeoTransform& t = m.map_from_pixel;
  if (!(sane(t.origin_x) && sane(t.origin_y) && sane(t.x_per_col) && sane(t.x_per_row) && sane(t.y_per_col) &&
        sane(t.y_per_row) && std::abs(t.determinant()) > 1e-12)) {
    return "its transform from pixels to the grid cannot be inverted";
  }
  if (!(level.gsd_m > 0 && level.gsd_m <= kMaxTileRadius_m)) {
    return "gsd_m = " + format_number(level.gsd_m) + " is outside (0, " + format_number(kMaxTileRadius_m) + "]";
  }
  // The same bound as for the matrix of a tile: a grid in metres stretches or squeezes the ground by less than ten.
  const double grid_gsd_m = std::sqrt(std::abs(t.determinant()));
  if (!(level.gsd_m <= 10 * grid_gsd_m && grid_gsd_m <= 10 * level.gsd_m)) {
    return "gsd_m = " + format_number(level.gsd_m) + " is not that of its transform, whose pixels are " +
           format_number(grid_gsd_m) + " m of the grid";
  }
  if (m.tile_size_px < 1 || m.stride_px < 1 || m.tile_size_px > kMaxMapWindowPx || m.stride_px > kMaxMapWindowPx) {
    return "tile_size_px = " + std::to_string(m.tile_size_px) + " or stride_px = " + std::to_string(m.stride_px) +
           " is outside [1, " + std::to_string(kMaxMapWindowPx) + "]";
  }
  if (m.grid_width_px < 1 || m.grid_height_px < 1) return "its grid has no pixels";
  if (!(level.max_tile_radius_m >= 0 && level.max_tile_radius_m <= kMaxTileRadius_m)) {
    return "max_tile_radius_m = " + format_number(level.max_tile_radius_m) + " is outside [0, " +
           format_number(kMaxTileRadius_m) + "]";
  }
  return {};
}

MapLevel read_level_row(const Statement& statement, const std::string& file) {
  MapLevel level;
  const auto real_or_nan = [&](int column) {
    return statement.is_null(column) ? std::numeric_limits<double>::quiet_NaN() : statement.real(column);
  };
  level.matrix.level = statement.integer(0, kMinInt, kMaxInt);
  level.gsd_m = statement.real(1);
  level.min_agl_m = real_or_nan(2);
  level.max_agl_m = real_or_nan(3);
  level.matrix.map_from_pixel = {statement.real(4), statement.real(5), statement.real(6),
                                 statement.real(7), statement.real(8), statement.real(9)};
  level.matrix.grid_width_px = statement.integer(10);
  level.matrix.grid_height_px = statement.integer(11);
  level.matrix.tile_size_px = statement.integer(12, kMinInt, kMaxInt);
  level.matrix.stride_px = statement.integer(13, kMinInt, kMaxInt);
  level.max_tile_radius_m = statement.real(14);
  const std::string problem = level_problem(level);
  if (!problem.empty()) throw DataError(file + ": level " + std::to_string(level.matrix.level) + ": " + problem);
  return level;
}

double tile_radius_m(const MapTile& tile) {
  const Eigen::Vector2d half(tile.bounds.width_m() / 2, tile.bounds.height_m() / 2);
  return std::max((tile.enu_from_grid * half).norm(),
                  (tile.enu_from_grid * Eigen::Vector2d(half.x(), -half.y())).norm());
}

}  // namespace pilotage
