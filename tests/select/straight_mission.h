#pragma once

#include <cmath>

#include "testing/drift_after.h"

#include "pilotage/ground/tile_scores.h"
#include "pilotage/ins/drift.h"
#include "pilotage/mission/mission.h"
#include "pilotage/mission/stored_size.h"

namespace pilotage::testing {

/// A mission over a straight eastward route of `length_m` at y = 0, flown at 20 m/s, one level of tiles of 100 m every
/// 50 m, in a band of ± `half_width_m`. No wind, a map without error, no frame dropped. No CRS, no imagery: enough
/// for selection.
inline Mission straight_mission(double length_m, double half_width_m = 50, int legs = 1) {
  Mission mission;
  mission.flight.max_error_m = 50;
  mission.flight.conditions = {0, 0, 300, 0};
  mission.flight.corridor_half_width_m = half_width_m;
  mission.flight.route.name = "straight";
  GridLevel level;
  level.gsd_m = 1;
  level.matrix.tile_size_px = 100;
  level.matrix.stride_px = 50;
  level.matrix.map_from_pixel = GeoTransform::north_up(-500, 500, 1);
  level.matrix.grid_width_px = static_cast<std::int64_t>(length_m) + 1000;
  level.matrix.grid_height_px = 1000;
  mission.ground.levels.push_back(level);
  for (int leg = 0; leg < legs; ++leg) {
    mission.flight.route.legs.push_back({leg, leg + 1, length_m / legs});
    const int steps = static_cast<int>(length_m / legs / 10);
    for (int i = 0; i <= steps; ++i) {
      FlightSample sample;
      sample.leg = leg;
      sample.distance_m = leg * length_m / legs + 10.0 * i;
      sample.point_map_m = {sample.distance_m, 0};
      sample.azimuth_deg = 90;
      sample.speed_mps = 20;
      sample.agl_m = 120;
      sample.level = 0;
      mission.flight.samples.push_back(sample);
    }
  }
  const TileMatrix& matrix = level.matrix;
  for (std::int64_t row = 0; row < matrix.matrix_height(); ++row) {
    for (std::int64_t column = 0; column < matrix.matrix_width(); ++column) {
      GroundTile tile;
      tile.tile_id = tile_id_of(mission.ground.levels, 0, column, row);
      tile.column = column;
      tile.row = row;
      tile.bounds = {-500.0 + 50.0 * static_cast<double>(column), 400.0 - 50.0 * static_cast<double>(row),
                     -400.0 + 50.0 * static_cast<double>(column), 500.0 - 50.0 * static_cast<double>(row)};
      tile.valid_fraction = 1;
      const RoutePlace place{tile.bounds.center_m().x(), std::abs(tile.bounds.center_m().y())};
      if (place.offset_m > half_width_m || place.distance_m < 0 || place.distance_m > length_m) continue;
      mission.ground.tiles.push_back(tile);
      mission.flight.places.push_back(place);
    }
  }
  return mission;
}

/// Good scores for every tile of the plan.
inline std::vector<TileScores> good_scores(const Mission& mission) {
  std::vector<TileScores> scores(mission.ground.tiles.size());
  for (TileScores& score : scores) {
    score.valid_fraction = 1;
    score.degraded.margin = 0.5;
  }
  return scores;
}

/// What a map of it stores.
inline constexpr StoredSize kStoredSize{.bytes_per_px = 0.5, .bytes_per_tile = 700, .bytes_fixed = 100000};

/// The position error `time_s` seconds after the loss of GNSS.
inline double error_after_s(const Mission& mission, double time_s) {
  const InsErrorModel model = make_ins_error_model(mission.flight.ins);
  return position_error_m(drift_after(model, time_s, 20, model.start_sigma_m), model.sigma_multiple);
}

}  // namespace pilotage::testing
