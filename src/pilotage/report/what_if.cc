#include "pilotage/report/what_if.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string>

#include "pilotage/base/json_object.h"
#include "pilotage/base/utf8.h"
#include "pilotage/ground/place_level.h"
#include "pilotage/ground/tile_chances.h"
#include "pilotage/mission/chances_beside_line.h"
#include "pilotage/mission/tile_under.h"
#include "pilotage/report/page_flight_json.h"
#include "pilotage/report/page_text.h"
#include "pilotage/verdict/disagreement.h"
#include "pilotage/verdict/verdict.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

// [number of neighbours with one key, their value] along the samples.
template <class Key, class Value>
Json runs_of(std::size_t count, Key key_of, Value value_of) {
  Json runs = Json::array();
  for (std::size_t first = 0; first < count;) {
    std::size_t end = first + 1;
    while (end < count && key_of(end) == key_of(first)) ++end;
    runs.push_back(Json::array({end - first, value_of(first)}));
    first = end;
  }
  return runs;
}

// Way over which tries fare alike at a sample.
double apart_m(const Mission& mission, const FlightSample& sample, const FixTries& tries) {
  if (tries.decorrelation_m) return *tries.decorrelation_m;
  if (sample.level == FlightSample::kNoLevel) return mission.flight.footprint_width_m;
  const TileMatrix& matrix = mission.ground.levels[static_cast<std::size_t>(sample.level)].matrix;
  return matrix.tile_size_px * std::abs(matrix.map_from_pixel.x_per_col);
}

Json flight_json(const ReportInput& input) {
  const Mission& mission = input.mission;
  const std::vector<FlightSample>& samples = mission.flight.samples;
  const std::set<std::int64_t> stored(input.selection.tile_ids.begin(), input.selection.tile_ids.end());
  std::vector<double> numbers;
  std::vector<std::optional<std::size_t>> tiles;
  for (const FlightSample& sample : samples) {
    numbers.push_back(sample.distance_m);
    tiles.push_back(tile_under(mission, sample));
    if (tiles.back() && !stored.contains(mission.ground.tiles[*tiles.back()].tile_id)) tiles.back().reset();
  }
  for (const FlightSample& sample : samples) numbers.push_back(sample.azimuth_deg);
  const TileChances chances = tile_chances(input.scores, std::vector<bool>(input.scores.size(), true));
  const auto p_at_levels = [&](std::size_t tile) {
    Json p = Json::array({chances.p[tile]});
    for (const TileChances::AtLevel& level : chances.levels) p.push_back(level.p[tile]);
    return p;
  };
  const auto same = [&](auto value_of) { return runs_of(samples.size(), value_of, value_of); };
  Json json;
  json["samples"] = base64_doubles(numbers);
  json["leg_runs"] = same([&](std::size_t i) { return samples[i].leg; });
  json["speed_runs"] = same([&](std::size_t i) { return samples[i].speed_mps; });
  json["apart_runs"] = same([&](std::size_t i) { return apart_m(mission, samples[i], *input.selection.tries); });
  json["tile_runs"] = runs_of(
      samples.size(), [&](std::size_t i) { return tiles[i]; },
      [&](std::size_t i) -> Json {
        if (!tiles[i]) return nullptr;
        return p_at_levels(*tiles[i]);
      });
  json["level_weights"] = Json::array();
  for (const TileChances::AtLevel& level : chances.levels) json["level_weights"].push_back(level.weight);
  json["level_interval"] = Json::array({kLevelLow, kLevelHigh});
  json["cases"] = wind_cases_json(mission.flight.conditions, chances.levels.size());
  std::vector<double> p_of_stored = chances.p;
  for (std::size_t i = 0; i < p_of_stored.size(); ++i) {
    if (!stored.contains(mission.ground.tiles[i].tile_id)) p_of_stored[i] = 0;
  }
  std::vector<double> beside_line;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const ChancesBesideLine beside = chances_beside_line(mission, samples[i], p_of_stored);
    beside_line.push_back(beside.step_m);
    beside_line.insert(beside_line.end(), beside.shares.begin(), beside.shares.end());
  }
  json["beside_line"] = base64_doubles(beside_line);
  json["frames_that_come"] = 1 - mission.flight.conditions.dropped_frames;
  json["false_fix_rate"] = input.selection.tries->false_fix_rate;
  json["leg_lengths_m"] = Json::array();
  for (const RouteLeg& leg : mission.flight.route.legs) json["leg_lengths_m"].push_back(leg.length_m);
  json["denied"] = Json::array();
  for (const DeniedStretch& stretch : mission.flight.denied.stretches) {
    json["denied"].push_back({stretch.from_distance_m, stretch.to_distance_m});
  }
  json["anywhere"] = mission.flight.denied.anywhere;
  return json;
}

}  // namespace

Json what_if_data(const ReportInput& input, const std::vector<QualityRow>& quality) {
  const Flight& flight = input.mission.flight;
  const Selection& selection = input.selection;
  const bool flown = !flight.samples.empty() && std::all_of(flight.samples.begin(), flight.samples.end(),
                                                            [](const auto& s) { return s.speed_mps > 0; });
  if (!selection.tries || !flown) return nullptr;
  Json json = flight_json(input);
  json["models"] = ins_choices_json(flight.ins, flight.conditions);
  json["max_error_m"] = selection.max_error_m;
  json["fix_interval_s"] = selection.tries->interval_s;
  json["min_route_probability"] = selection.probability ? Json(selection.probability->min_p_within_limit) : Json();
  json["matchable_fraction"] = selection.matchable_fraction;
  json["interval_below"] = kIntervalBelow;
  json["disagreement"] = nullptr;
  if (const auto apart = georeference_disagreement(judged_plan(input))) {
    json["disagreement"] = {{"largest_m", apart->largest_m}, {"median_m", apart->median_m}};
  }
  static const std::set<std::string> kPredicted = {"largest_error",     "longest_gap",
                                                   "route_probability", "georeference_disagreement",
                                                   "simulated_flights", "rendered_flights"};
  json["others"] = Json::array();
  for (const QualityRow& row : quality) {
    if (!row.decides || kPredicted.contains(row.name)) continue;
    json["others"].push_back({{"name", row.name},
                              {"label", row.label},
                              {"value", valid_utf8(row.value)},
                              {"status", status_name(row.status)}});
  }
  json["assumes"] = {{"gnss", gnss_text(flight, selection)},
                     {"limit_default", limit_is_default(flight, selection)},
                     {"further", further_assumptions(input.mission, selection)}};
  return json;
}

}  // namespace pilotage
