#include "pilotage/report/sketch.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "pilotage/base/error.h"
#include "pilotage/ground/place_level.h"
#include "pilotage/ground/tile_chances.h"
#include "pilotage/report/page_flight_json.h"
#include "pilotage/report/page_text.h"
#include "pilotage/route/qgc_plan_writer.h"
#include "pilotage/verdict/quality.h"
#include "pilotage/verdict/verdict.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kAssumedSpeed_mps = 15;

Json waypoint_json(const FlightSample& sample, bool first) {
  const auto rounded = [](double value, double steps) { return std::round(value * steps) / steps; };
  return Json::array({rounded(sample.point.lon_deg, 1e8), rounded(sample.point.lat_deg, 1e8),
                      rounded(sample.agl_m, 100), first ? Json() : Json(sample.speed_mps)});
}

// The ends of all legs; nothing where they are not one line.
Json points_json(const Flight& flight) {
  Json points = Json::array();
  try {
    require_one_line(flight.route);
  } catch (const DataError&) {
    return points;
  }
  const std::vector<FlightSample>& samples = flight.samples;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (i == 0) points.push_back(waypoint_json(samples[i], true));
    const bool ends_leg = i + 1 == samples.size() || samples[i + 1].leg != samples[i].leg;
    if (ends_leg) points.push_back(waypoint_json(samples[i], false));
  }
  return points;
}

void add_tiles(const Mission& mission, const std::vector<TileScores>& scores, const LeftOut& least, Json& json) {
  std::vector<bool> counts(scores.size());
  for (std::size_t i = 0; i < scores.size(); ++i) {
    counts[i] = can_be_matched(scores[i], least.min_p_correct_fix, least.min_peak_margin);
  }
  const TileChances chances = tile_chances(scores, counts);
  json["without_p"] = tiles_without_p(scores, counts);
  std::vector<std::size_t> order(scores.size());  // the page's: by tile_id
  std::iota(order.begin(), order.end(), 0U);
  const std::vector<GroundTile>& tiles = mission.ground.tiles;
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return tiles[a].tile_id < tiles[b].tile_id; });
  std::vector<double> logits;
  Json runs = Json::array();
  for (const std::size_t i : order) {
    const double sigma = scores[i].level_sigma > 0 ? scores[i].level_sigma : 0;
    logits.push_back(logit_of_p(chances.p[i], sigma));
    if (runs.empty() || runs.back()[1] != sigma) runs.push_back(Json::array({0, sigma}));
    runs.back()[0] = runs.back()[0].get<int>() + 1;
  }
  json["logits"] = base64_doubles(logits);
  json["sigma_runs"] = std::move(runs);
  json["level_z"] = Json::array();
  json["level_weights"] = Json::array();
  for (std::size_t k = 0; k < chances.levels.size(); ++k) {
    json["level_z"].push_back(chances.levels.size() == 1 ? 0 : level_nodes()[k].z);
    json["level_weights"].push_back(chances.levels[k].weight);
  }
  json["level_interval"] = Json::array({kLevelLow, kLevelHigh});
  json["cases"] = wind_cases_json(mission.flight.conditions, chances.levels.size());
}

}  // namespace

Json sketch_data(const Mission& mission, const std::vector<TileScores>& scores, const Selection& selection,
                 const Json& mission_file) {
  if (!selection.tries || !selection.left_out || !selection.probability) return nullptr;
  const Flight& flight = mission.flight;
  Json json;
  const bool flown = !flight.samples.empty();
  const Json points = points_json(flight);
  json["points"] = points;
  json["agl_m"] = !points.empty() ? points.back()[2]
                  : flown         ? Json(flight.samples.front().agl_m)
                                  : Json(mission.ground.levels.front().max_agl_m);
  json["speed_mps"] = flown ? flight.samples.front().speed_mps : kAssumedSpeed_mps;
  json["min_agl_m"] = flight.min_agl_m;
  const bool given = mission_file.is_object() ? mission_file.contains("corridor_half_width_m")
                                              : flown && flight.corridor_half_width_m != flight.max_error_m;
  json["corridor_half_width_m"] = given ? Json(flight.corridor_half_width_m) : Json();
  json["levels"] = Json::array();
  for (const GridLevel& level : mission.ground.levels) {
    json["levels"].push_back({level.matrix.level, level.min_agl_m, level.max_agl_m});
  }
  add_tiles(mission, scores, *selection.left_out, json);
  json["models"] = ins_choices_json(flight.ins, flight.conditions);
  json["max_error_m"] = selection.max_error_m;
  json["fix_interval_s"] = selection.tries->interval_s;
  json["apart_m"] = selection.tries->decorrelation_m ? Json(*selection.tries->decorrelation_m) : Json();
  json["false_fix_rate"] = selection.tries->false_fix_rate;
  json["frames_that_come"] = 1 - flight.conditions.dropped_frames;
  json["min_route_probability"] = selection.probability->min_p_within_limit;
  json["interval_below"] = kIntervalBelow;
  json["assumes"] = {{"gnss", gnss_text(Flight{}, Selection{})},
                     {"limit_default", limit_is_default(flight, selection)},
                     {"further", further_assumptions(mission, selection)}};
  json["mission"] = mission_file;
  return json;
}

void add_grid(const Ground& ground, Json& mission_file) {
  const GridLevel& level = ground.levels.front();
  const GeoTransform& map_from_pixel = level.matrix.map_from_pixel;
  mission_file["crs"] = ground.crs.wkt();
  mission_file["grid_origin_m"] = {map_from_pixel.origin_x, map_from_pixel.origin_y};
  if (ground.levels.size() > 1) return;  // each level has pixels of its own
  mission_file["gsd_m"] = level.gsd_m;
  mission_file["tile_size_px"] = level.matrix.tile_size_px;
}

Json sketch_mission(const Json& parameters, const Ground& ground) {
  if (!parameters.contains("imagery") || !parameters.contains("route")) return nullptr;
  Json mission = parameters;
  // What is drawn says route, heights and speeds itself.
  for (const char* key :
       {"route", "agl_m", "speed_mps", "home_amsl_m", "height_reference", "layer", "feature", "denied"}) {
    mission.erase(key);
  }
  // Every tile that can be matched is stored.
  if (mission.contains("select")) {
    for (const char* key : {"budget", "sparse"}) mission["select"].erase(key);
  }
  add_grid(ground, mission);
  return mission;
}

}  // namespace pilotage
