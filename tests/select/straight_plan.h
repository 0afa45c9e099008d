#pragma once

#include <cmath>

#include "pilotage/mission/tile_lookup.h"
#include "pilotage/mission/tile_plan.h"
#include "pilotage/mission/tile_scores.h"

namespace pilotage::testing {

/// A plan over a straight eastward route of `length_m` at y = 0, flown at 20 m/s, one level of tiles of 100 m every 50
/// m, in a band of ± `half_width_m`. No CRS, no imagery: enough for selection.
inline TilePlan straight_plan(double length_m, double half_width_m = 50, int legs = 1) {
  TilePlan plan;
  plan.max_error_m = 50;
  plan.corridor_half_width_m = half_width_m;
  plan.route.name = "straight";
  PlanLevel level;
  level.gsd_m = 1;
  level.matrix.tile_size_px = 100;
  level.matrix.stride_px = 50;
  level.matrix.map_from_pixel = GeoTransform::north_up(-500, 500, 1);
  level.matrix.grid_width_px = static_cast<std::int64_t>(length_m) + 1000;
  level.matrix.grid_height_px = 1000;
  plan.levels.push_back(level);
  for (int leg = 0; leg < legs; ++leg) {
    plan.route.legs.push_back({leg, leg + 1, length_m / legs});
    const int steps = static_cast<int>(length_m / legs / 10);
    for (int i = 0; i <= steps; ++i) {
      PlanSample sample;
      sample.leg = leg;
      sample.distance_m = leg * length_m / legs + 10.0 * i;
      sample.point_map_m = {sample.distance_m, 0};
      sample.azimuth_deg = 90;
      sample.speed_mps = 20;
      sample.agl_m = 120;
      sample.level = 0;
      plan.route_samples.push_back(sample);
    }
  }
  const TileMatrix& matrix = level.matrix;
  for (std::int64_t row = 0; row < matrix.matrix_height(); ++row) {
    for (std::int64_t column = 0; column < matrix.matrix_width(); ++column) {
      PlanTile tile;
      tile.tile_id = tile_id_of(plan.levels, 0, column, row);
      tile.column = column;
      tile.row = row;
      tile.bounds = {-500.0 + 50.0 * static_cast<double>(column), 400.0 - 50.0 * static_cast<double>(row),
                     -400.0 + 50.0 * static_cast<double>(column), 500.0 - 50.0 * static_cast<double>(row)};
      tile.valid_fraction = 1;
      tile.route_offset_m = std::abs(tile.bounds.center_m().y());
      tile.route_distance_m = tile.bounds.center_m().x();
      if (tile.route_offset_m <= half_width_m && tile.route_distance_m >= 0 && tile.route_distance_m <= length_m) {
        plan.tiles.push_back(tile);
      }
    }
  }
  return plan;
}

/// Good scores for every tile of the plan.
inline std::vector<TileScore> good_scores(const TilePlan& plan) {
  std::vector<TileScore> scores;
  for (const PlanTile& tile : plan.tiles) {
    TileScore score;
    score.tile_id = tile.tile_id;
    score.valid_fraction = 1;
    score.degraded.margin = 0.5;
    scores.push_back(score);
  }
  return scores;
}

}  // namespace pilotage::testing
