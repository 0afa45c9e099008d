#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "pilotage/ground/tile_scores.h"
#include "pilotage/mission/mission.h"
#include "pilotage/mission/selection.h"

namespace pilotage {

/// What the page needs to predict the flight along a line that is drawn on it (page_sketch.js; the flight itself as in
/// what_if.h): over all tiles that can be matched, as `select` chooses them without a budget, GNSS lost at the first
/// point. Null where the selection does not say when a flight tries to fix, from which P on a tile counts, or how often
/// a flight is to succeed.
///   points        the mission's route, to start from: [longitude, latitude, height above ground, speed of the leg that
///                 leads there (null: the first)] of each waypoint; empty without a route that is one line
///   agl_m, speed_mps
///                 of a point that is drawn where there is none
///   min_agl_m     lower than this no fix is expected
///   corridor_half_width_m
///                 as planned; null where it is the limit
///   levels        [level, lowest, highest height above ground that it serves]
///   logits, sigma_runs
///                 of each tile of the ground, by tile_id: base64 of little-endian doubles, the logit of P at the level
///                 of the place 0 (−∞: not counted on); and [number of tiles, standard deviation of the level]
///   level_z, level_weights, level_interval, cases, models, frames_that_come, false_fix_rate, …
///                 as in what_if.h; the level z is in standard deviations
///   without_p     how many of the tiles that count have no P and are taken to be certain
///   mission       the mission file of what was planned, without route, for `prepare` and `reroute`; `mission_file` as
///                 it is given
nlohmann::ordered_json sketch_data(const Mission& mission, const std::vector<TileScores>& scores,
                                   const Selection& selection, const nlohmann::ordered_json& mission_file);

/// The mission file that `parameters` of `prepare` are, on the grid of the ground, without route and what is said of
/// it; null of another stage's.
nlohmann::ordered_json sketch_mission(const nlohmann::ordered_json& parameters, const Ground& ground);

/// Makes a mission file ask for the tiles of the ground's first level: its CRS, pixels, size of tiles and a corner.
void add_grid(const Ground& ground, nlohmann::ordered_json& mission_file);

}  // namespace pilotage
