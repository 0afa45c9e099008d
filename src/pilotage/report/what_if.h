#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "pilotage/report/report_input.h"
#include "pilotage/verdict/quality.h"

namespace pilotage {

/// What the page needs to predict the flight again with another limit, inertial grade, speed and interval between tries
/// (page_flight.js, by the formulas of select/route_error.h and select/route_probability.h), over the map as it is
/// built. Numbers have all their digits, so that ties fall as they do here. Null where the selection does not say when
/// a flight tries to fix (one that `select` did not make), and where the route has no sample or a sample no speed.
///   samples       base64 of little-endian doubles: the distance of each sample in metres, then the azimuth of each in
///                 degrees
///   leg_runs, speed_runs, apart_runs, tile_runs
///                 [number of samples, value] along the route: leg (from 0), speed (m/s), way over which tries fare
///                 alike (m), and of the stored tile below (null: none) [P of a correct fix, P at each level of the
///                 place]; a run for each tile
///   level_weights, level_interval
///                 how much each level counts, and the two whose P are the ends of the interval
///   cases         [index of the level, weight at that level, wind east and north in m/s]: what P is the mean over
///   beside_line   base64 of little-endian doubles: of each sample the step_m and the shares of ChancesBesideLine
///   models        what is planned, then each grade with the figures of its own that the plan gives (InsErrorModel)
///   others        rows of the quality table that decide and are not predicted here
nlohmann::ordered_json what_if_data(const ReportInput& input, const std::vector<QualityRow>& quality);

}  // namespace pilotage
