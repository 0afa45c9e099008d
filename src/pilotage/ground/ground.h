#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pilotage/geo/bounds.h"
#include "pilotage/geo/geodetic_point.h"
#include "pilotage/geo/tile_matrix.h"
#include "pilotage/raster/crs.h"
#include "pilotage/raster/gdal_imagery.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// A square of ground of the size of a camera's footprint: what is scored, stored and matched.
struct GroundTile {
  std::int64_t tile_id = 0;  ///< Unique over all levels; ascending in (level, row, column): tile_id_of.
  int level = 0;
  std::int64_t column = 0;
  std::int64_t row = 0;
  Bounds bounds;  ///< Along the axes of the ground's CRS, in metres (feet are converted); NaN where it counts degrees.
  GeodeticPoint center;
  /// Standard deviation of where the imagery lies over it, each axis; nothing where nobody says.
  std::optional<double> map_sigma_m;
  double valid_fraction = 0;  ///< Share of it that the imagery covers, 0 … 1, as known before it is scored.

  TileCell cell() const { return {column, row}; }
};

/// A grid of tiles at one ground sample distance. Levels of a mission serve one band of heights each.
struct GridLevel {
  TileMatrix matrix;
  double gsd_m = 0;
  double min_agl_m = 0;  ///< Heights above ground whose frames are compared with it.
  double max_agl_m = 0;
  int search_radius_px = 0;
};

/// A raster of the reference imagery, as it was when the grid was cut.
struct ImageryDataset {
  std::string dataset;  ///< As given: a GDAL dataset string.
  double gsd_m = 0;
  std::string crs;
  std::string acquired;  ///< Date of the imagery where its metadata tell, else "".
  int width_px = 0;
  int height_px = 0;
  std::string map_sigma = {};  ///< Raster of its own error (raster/map_sigma.h), "" when it names none.
  Licence licence = {};
};

/// The reference imagery and how it is read.
struct Imagery {
  std::vector<ImageryDataset> datasets;  ///< Later ones on top.
  ImageryOptions options;
  bool own_grid = false;  ///< One raster on its own pixel grid: nothing is resampled.
};

/// Most tiles that a ground, or a level of one, is given: with their scores, rows and bands some kilobytes each, some
/// 16 GB.
inline constexpr std::int64_t kMostTiles = 10'000'000;

/// What can be scored: imagery cut into tiles, level by level, in one CRS. It knows no route. Scores of a ground are a
/// vector with one TileScores for each tile, in the order of `tiles`.
struct Ground {
  Crs crs;
  double max_scale_distortion = 0;  ///< Largest |scale − 1| of the grid over the tiles; 0 where nobody asked.
  std::vector<GridLevel> levels;    ///< levels[i].matrix.level = i.
  Imagery imagery;
  std::string elevation;                    ///< GDAL dataset string, "" when none was given.
  std::optional<double> elevation_sigma_m;  ///< Standard deviation of its heights; nothing without one.
  std::string elevation_datum;              ///< What its heights were taken for (Elevation::vertical_datum);
  bool elevation_datum_assumed = false;     ///< it does not say so itself.
  Licence elevation_licence;                ///< Of the elevation model.
  /// When the flight over it begins, as parse_utc_date() takes it; "" when the planner did not say.
  std::string flight_time;
  std::vector<GroundTile> tiles;  ///< Ascending tile_id.

  const GridLevel& level_of(const GroundTile& tile) const { return levels[static_cast<std::size_t>(tile.level)]; }
  PixelWindow window_of(const GroundTile& tile) const { return level_of(tile).matrix.tile_window(tile.cell()); }
};

/// The tile_id of a matrix cell: ids count the cells of level 0 row by row, then those of level 1, and so on.
std::int64_t tile_id_of(const std::vector<GridLevel>& levels, int level, std::int64_t column, std::int64_t row);

/// Index into ground.tiles; nothing when it has no such tile.
std::optional<std::size_t> find_tile(const Ground& ground, std::int64_t tile_id);

/// The same; throws DataError, beginning with `what` ("the selection"), when it has no such tile.
std::size_t tile_index(const Ground& ground, std::int64_t tile_id, const std::string& what);

}  // namespace pilotage

#pragma GCC visibility pop
