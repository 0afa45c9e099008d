#include "pilotage/evaluate/scored_ground.h"

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

bool has_ground(const TileRow& row) {
  return row.score.status != TileStatus::kTooLittleGround;
}

void require_metric_grid(const ScoredGround& ground) {
  const GeoTransform& t = ground.matrix.map_from_pixel;
  const bool square = t.x_per_row == 0 && t.y_per_col == 0 && t.x_per_col > 0 && t.y_per_row == -t.x_per_col;
  if (square && ground.crs.metres_per_unit() == 1.0) return;
  throw UsageError(
      "the scores' grid is not north-up, of square pixels in metres, as a map must be to be matched; give --gsd-m "
      "(and --crs), or --evaluate-matcher ncc");
}

/// A camera that a map must name, though nobody asks it for one here.
Camera any_camera(int side_px) {
  Camera camera{side_px, side_px};
  camera.fx_px = camera.fy_px = side_px;
  camera.cx_px = camera.cy_px = side_px / 2.0;
  return camera;
}

/// A plan of one level and, as a map needs a route, one leg across the grid.
Mission plan_of(const ScoredGround& ground) {
  Mission plan;
  plan.ground.crs = ground.crs;
  plan.ground.levels.push_back({ground.matrix, ground_gsd_m(ground), 1, 1e5, ground.search_radius_px});
  for (const TileRow& row : ground.rows) plan.ground.tiles.push_back(row.tile);
  plan.flight.places.resize(plan.ground.tiles.size());
  for (const std::string& dataset : ground.datasets) {
    plan.ground.imagery.datasets.emplace_back();
    plan.ground.imagery.datasets.back().dataset = dataset;
  }
  plan.ground.imagery.options = ground.imagery;
  plan.ground.elevation = ground.elevation;
  plan.flight.route.name = "evaluation";
  plan.flight.route.legs.push_back({0, 1, 0});
  for (const GroundTile* tile : {&plan.ground.tiles.front(), &plan.ground.tiles.back()}) {
    FlightSample sample;
    sample.point = tile->center;
    plan.flight.samples.push_back(sample);
  }
  plan.flight.camera = any_camera(ground.matrix.tile_size_px);
  return plan;
}

}  // namespace

Eigen::Vector2d same_place(const Eigen::Vector2d& point_map) {
  return point_map;
}

Eigen::Vector2d tile_center(const ScoredGround& ground, const TileRow& row) {
  const double half = ground.matrix.tile_size_px / 2.0;
  return ground.matrix.map_from_pixel.map_from_pixel(
      {static_cast<double>(row.min_col_px) + half, static_cast<double>(row.min_row_px) + half});
}

double ground_gsd_m(const ScoredGround& ground) {
  const Eigen::Vector2d middle(static_cast<double>(ground.matrix.grid_width_px) / 2,
                               static_cast<double>(ground.matrix.grid_height_px) / 2);
  const GroundPlace place = ground_place(ground.crs, ground.matrix.map_from_pixel, middle);
  return 1 / std::sqrt(std::abs(place.pixel_from_enu_m.determinant()));
}

std::vector<std::size_t> choose_tiles(const ScoredGround& ground, int stride, int max_tiles, std::uint64_t seed) {
  std::vector<std::size_t> tiles;
  for (std::size_t i = 0; i < ground.rows.size(); ++i) {
    const TileRow& row = ground.rows[i];
    if (has_ground(row) && row.tile.column % stride == 0 && row.tile.row % stride == 0) tiles.push_back(i);
  }
  if (max_tiles <= 0 || tiles.size() <= static_cast<std::size_t>(max_tiles)) return tiles;
  const auto draw = [&](std::size_t i) {
    return derive_seed(seed, static_cast<std::uint64_t>(ground.rows[i].tile.tile_id));
  };
  std::sort(tiles.begin(), tiles.end(),
            [&](std::size_t a, std::size_t b) { return std::pair(draw(a), a) < std::pair(draw(b), b); });
  tiles.resize(static_cast<std::size_t>(max_tiles));
  std::sort(tiles.begin(), tiles.end());
  return tiles;
}

std::int64_t block_of(const ScoredGround& ground, const TileRow& row, double block_px) {
  const double half = ground.matrix.tile_size_px / 2.0;
  const auto along = [&](std::int64_t first_px) {
    return static_cast<std::int64_t>((static_cast<double>(first_px) + half) / block_px);
  };
  const auto across = static_cast<std::int64_t>(static_cast<double>(ground.matrix.grid_width_px) / block_px) + 1;
  return along(row.min_row_px) * across + along(row.min_col_px);
}

void build_evaluation_map(const std::filesystem::path& path, const ScoredGround& ground, bool chips, int threads,
                          const Progress& progress) {
  require_metric_grid(ground);
  const Mission plan = plan_of(ground);
  std::vector<TileScore> scores;
  Selection selection;
  for (const TileRow& row : ground.rows) {
    if (!has_ground(row)) continue;
    scores.push_back(row.score);
    selection.tile_ids.push_back(row.tile.tile_id);
  }
  BuildOptions options;
  options.chips.chips = chips;
  build_map(path, plan, scores, selection, {}, "evaluation", options, true, threads, progress);
}

}  // namespace pilotage
