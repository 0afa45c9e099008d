#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pilotage/base/progress.h"
#include "pilotage/ground/score_table.h"

namespace pilotage {

/// Where on the scored imagery the ground lies that the other date's georeference puts at a point: both in the CRS of
/// the ground. This is the one place through which the truth of an evaluation passes; a registration of the two dates
/// goes in here. Called by several threads at a time.
using PlaceOnReference = std::function<Eigen::Vector2d(const Eigen::Vector2d& point_map)>;

/// The point itself: both georeferences are taken to agree.
Eigen::Vector2d same_place(const Eigen::Vector2d& point_map);

/// Mean ground length of a pixel of the grid at its centre, on the ellipsoid. Throws DataError where the grid has no
/// longitude and latitude.
double ground_gsd_m(const LevelScores& judged);

/// Indices into ground.tiles of the tiles of the level to judge: those with enough ground, of every `stride`-th column
/// and row, and of these at most `max_tiles` (0 = all) that `seed` draws; fewer tiles are a subset of more. Ascending.
std::vector<std::size_t> choose_tiles(const LevelScores& judged, int stride, int max_tiles, std::uint64_t seed);

/// The number of the square block of side `block_px` that holds a tile's centre; blocks begin at the grid's first
/// pixel.
std::int64_t block_of(const LevelScores& judged, const GroundTile& tile, double block_px);

/// Writes a map database of all tiles with enough ground, with `pilotage build`'s defaults. Throws UsageError when the
/// grid is not north-up, of square pixels in metres; otherwise as build_map.
void build_evaluation_map(const std::filesystem::path& path, const LevelScores& judged, bool chips, int threads,
                          const Progress& progress);

}  // namespace pilotage
