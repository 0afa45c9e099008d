#include "pilotage/evaluate/evaluated_tiles.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"
#include "pilotage/build_map/build_map.h"
#include "pilotage/camera/render_frame.h"
#include "pilotage/geo/enu_from_grid.h"

namespace pilotage {
namespace {

bool has_ground(const LevelScores& judged, std::size_t tile) {
  return judged.has(tile) && judged.scores[tile].status != TileStatus::kTooLittleGround;
}

void require_metric_grid(const LevelScores& judged) {
  const GeoTransform& t = judged.matrix().map_from_pixel;
  const bool square = t.x_per_row == 0 && t.y_per_col == 0 && t.x_per_col > 0 && t.y_per_row == -t.x_per_col;
  if (square && judged.ground.crs.metres_per_unit() == 1.0) return;
  throw UsageError(
      "the scores' grid is not north-up, of square pixels in metres, as a map must be to be matched; give --gsd-m "
      "(and --crs), or --evaluate-matcher ncc");
}

}  // namespace

Eigen::Vector2d same_place(const Eigen::Vector2d& point_map) {
  return point_map;
}

double ground_gsd_m(const LevelScores& judged) {
  const Eigen::Vector2d middle(static_cast<double>(judged.matrix().grid_width_px) / 2,
                               static_cast<double>(judged.matrix().grid_height_px) / 2);
  const GroundPlace place = ground_place(judged.ground.crs, judged.matrix().map_from_pixel, middle);
  return 1 / std::sqrt(std::abs(place.pixel_from_enu_m.determinant()));
}

std::vector<std::size_t> choose_tiles(const LevelScores& judged, int stride, int max_tiles, std::uint64_t seed) {
  std::vector<std::size_t> tiles;
  for (std::size_t i = 0; i < judged.scores.size(); ++i) {
    const GroundTile& tile = judged.ground.tiles[i];
    if (has_ground(judged, i) && tile.column % stride == 0 && tile.row % stride == 0) tiles.push_back(i);
  }
  if (max_tiles <= 0 || tiles.size() <= static_cast<std::size_t>(max_tiles)) return tiles;
  const auto draw = [&](std::size_t i) {
    return derive_seed(seed, static_cast<std::uint64_t>(judged.ground.tiles[i].tile_id));
  };
  std::sort(tiles.begin(), tiles.end(),
            [&](std::size_t a, std::size_t b) { return std::pair(draw(a), a) < std::pair(draw(b), b); });
  tiles.resize(static_cast<std::size_t>(max_tiles));
  std::sort(tiles.begin(), tiles.end());
  return tiles;
}

std::int64_t block_of(const LevelScores& judged, const GroundTile& tile, double block_px) {
  const TileMatrix& matrix = judged.matrix();
  const PixelWindow window = matrix.tile_window(tile.cell());
  const auto along = [&](std::int64_t first_px) {
    return static_cast<std::int64_t>((static_cast<double>(first_px) + matrix.tile_size_px / 2.0) / block_px);
  };
  const auto across = static_cast<std::int64_t>(static_cast<double>(matrix.grid_width_px) / block_px) + 1;
  return along(window.row) * across + along(window.col);
}

void build_evaluation_map(const std::filesystem::path& path, const LevelScores& judged, bool chips, int threads,
                          const Progress& progress) {
  require_metric_grid(judged);
  constexpr double kLeastAgl_m = 1;
  constexpr double kMostAgl_m = 1e5;
  Ground ground = judged.ground;  // a map names its pixels as they are on the ground, and heights to be flown at
  for (GridLevel& level : ground.levels) {
    if (level.matrix.level == judged.matrix().level) level.gsd_m = ground_gsd_m(judged);
    level.min_agl_m = kLeastAgl_m;
    level.max_agl_m = kMostAgl_m;
  }
  std::vector<std::int64_t> stored;
  for (std::size_t i = 0; i < judged.scores.size(); ++i) {
    if (has_ground(judged, i)) stored.push_back(ground.tiles[i].tile_id);
  }
  BuildOptions options;
  options.chips.chips = chips;
  build_ground_map(path, {ground, judged.scores}, stored, options, threads, progress);
}

}  // namespace pilotage
