#include "pilotage/survey/sketched_flight.h"

#include <algorithm>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/options_json.h"
#include "pilotage/ground/tile_chances.h"
#include "pilotage/matchability/level_at_age.h"
#include "pilotage/raster/elevation.h"
#include "pilotage/report/sketch.h"
#include "pilotage/select/select_options.h"
#include "pilotage/tile/map_error.h"
#include "pilotage/tile/tile_options.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

// Whoever surveys for a low flight means to be matched there.
double lowest_agl_m(const SurveyedGround& area) {
  return std::min(TileOptions{}.min_agl_m, area.agl_m);
}

Mission flight_over(const SurveyedGround& area, std::vector<std::string>& notes, std::vector<std::string>& warnings) {
  Mission mission;
  mission.ground = area.ground;
  Flight& flight = mission.flight;
  flight.max_error_m = kAssumedMaxError_m;
  flight.max_error_assumed = true;
  flight.min_agl_m = lowest_agl_m(area);
  if (!mission.ground.elevation.empty()) {
    const Elevation model(mission.ground.elevation);
    mission.ground.elevation_datum = model.vertical_datum();
    mission.ground.elevation_datum_assumed = model.datum_assumed();
  }
  add_placement_error(area.imagery_infos, mission);
  try {
    add_map_sigma({}, mission);
  } catch (const DataError& error) {
    warnings.push_back(std::string(error.what()) + "; a route that is drawn takes it to be unknown, prepare does not");
  }
  for (const std::string& note : mission.notes) notes.push_back("For a route that is drawn: " + note);
  return mission;
}

Json mission_file(const SurveyedGround& area, const std::vector<std::string>& imagery, const SurveyOptions& options) {
  TileOptions tile;
  tile.imagery = imagery;
  tile.elevation = options.elevation;
  tile.imagery_options = options.imagery_options;
  tile.camera = options.camera;
  tile.imagery_date = options.imagery_date;
  tile.flight_time = options.flight_time;
  tile.tile_overlap = options.tile_overlap;
  tile.min_agl_m = lowest_agl_m(area);
  Json json = options_to_json(list_options(tile));
  add_grid(area.ground, json);
  ScoreOptions score = options.score;
  if (score.matcher == FlyingMatcher::kFeaturesAndChips) json["build"] = {{"chips", true}};
  json["score"] = options_to_json(list_options(score));
  return json;
}

}  // namespace

SketchedFlight sketched_flight(SurveyedGround& area, const std::vector<TileScores>& scores,
                               const std::vector<std::string>& imagery, const SurveyOptions& options) {
  SketchedFlight sketched;
  sketched.mission = flight_over(area, area.notes, area.warnings);
  const SelectOptions select;
  Selection& selection = sketched.selection;
  selection.tries = FixTries{select.fix_interval_s, select.fix_decorrelation_m, select.max_false_fix_rate};
  selection.left_out = LeftOut{select.min_p_correct_fix, select.min_peak_margin, {}};
  selection.max_error_m = sketched.mission.flight.max_error_m;
  if (!any_p_known(scores)) return sketched;  // nothing is drawn then
  sketched.mission_file = mission_file(area, imagery, options);
  const std::vector<bool> all(scores.size(), true);
  selection.probability = RouteProbability{0,
                                           select.min_route_probability,
                                           0,
                                           0,
                                           {},
                                           {},
                                           fewest_level_tiles(scores, all),
                                           counted_age_months(scores, all).value_or(kNaN)};
  return sketched;
}

}  // namespace pilotage
