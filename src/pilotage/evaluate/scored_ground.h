#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pilotage/base/progress.h"
#include "pilotage/geo/tile_matrix.h"
#include "pilotage/ground/tile_table.h"
#include "pilotage/mission/mission.h"
#include "pilotage/raster/gdal_crs.h"
#include "pilotage/raster/gdal_imagery.h"

namespace pilotage {

/// One level of scored tiles, whether of a plan or of a raster alone.
struct ScoredGround {
  Crs crs;
  TileMatrix matrix;
  int search_radius_px = 0;
  std::vector<TileRow> rows;          ///< Ascending tile_id; all of the matrix's level.
  std::vector<std::string> datasets;  ///< The imagery that was scored.
  ImageryOptions imagery;
  std::string elevation;  ///< GDAL dataset string, "" for none.
};

/// Where on the scored imagery the ground lies that the other date's georeference puts at a point: both in the CRS of
/// ScoredGround. This is the one place through which the truth of an evaluation passes; a registration of the two dates
/// goes in here. Called by several threads at a time.
using PlaceOnReference = std::function<Eigen::Vector2d(const Eigen::Vector2d& point_map)>;

/// The point itself: both georeferences are taken to agree.
Eigen::Vector2d same_place(const Eigen::Vector2d& point_map);

/// The centre of a tile, in the CRS.
Eigen::Vector2d tile_center(const ScoredGround& ground, const TileRow& row);

/// Mean ground length of a pixel of the grid at its centre, on the ellipsoid. Throws DataError where the grid has no
/// longitude and latitude.
double ground_gsd_m(const ScoredGround& ground);

/// Indices into `rows` of the tiles to judge: those with enough ground, of every `stride`-th column and row, and of
/// these at most `max_tiles` (0 = all) that `seed` draws; fewer tiles are a subset of more. Ascending.
std::vector<std::size_t> choose_tiles(const ScoredGround& ground, int stride, int max_tiles, std::uint64_t seed);

/// The number of the square block of side `block_px` that holds a tile's centre; blocks begin at the grid's first
/// pixel.
std::int64_t block_of(const ScoredGround& ground, const TileRow& row, double block_px);

/// Writes a map database of all tiles with enough ground, with `pilotage build`'s defaults. Throws UsageError when the
/// grid is not north-up, of square pixels in metres; otherwise as build_map.
void build_evaluation_map(const std::filesystem::path& path, const ScoredGround& ground, bool chips, int threads,
                          const Progress& progress);

}  // namespace pilotage
