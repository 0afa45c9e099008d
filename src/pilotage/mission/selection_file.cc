#include "pilotage/mission/selection_file.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/options_json.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kSelectionVersion = 3;
constexpr int kMaxLeg = 1'000'000;
constexpr double kMostImageryAge_months = 12 * 10'000;  // more than dates can be apart

// The file counts legs from 1, as people do.
int leg_index(JsonObject& object) {
  return object.small_integer("leg", 1, kMaxLeg) - 1;
}

std::string side_name(AdviceSide side) {
  if (side == AdviceSide::kNone) return "none";
  return side == AdviceSide::kLeft ? "left" : "right";
}

AdviceSide side_of(const std::string& name, const std::string& path) {
  for (const AdviceSide side : {AdviceSide::kNone, AdviceSide::kLeft, AdviceSide::kRight}) {
    if (side_name(side) == name) return side;
  }
  throw DataError(path + " = \"" + name + "\" is no side; allowed are none, left and right");
}

Json interval_to_json(const ProbabilityInterval& interval) {
  return {{"low", interval.low}, {"high", interval.high}};
}

ProbabilityInterval interval_from_json(JsonObject object) {
  const ProbabilityInterval interval{object.number("low"), object.number("high")};
  object.finish();
  return interval;
}

Json probability_to_json(const std::optional<RouteProbability>& probability) {
  if (!probability) return nullptr;
  Json json = {{"p_within_limit", probability->p_within_limit},
               {"min_p_within_limit", probability->min_p_within_limit},
               {"expected_fixes", probability->expected_fixes},
               {"expected_false_fixes", probability->expected_false_fixes},
               {"worst", nullptr},
               {"interval", nullptr},
               {"level_tiles", json_number(probability->level_tiles)},
               {"level_age_months", json_number(probability->level_age_months)},
               {"rests_on", rests_on_text(*probability)}};
  if (probability->interval) json["interval"] = interval_to_json(*probability->interval);
  if (const auto& worst = probability->worst) {
    json["worst"] = {{"leg", worst->leg + 1},
                     {"from_distance_m", worst->from_distance_m},
                     {"to_distance_m", worst->to_distance_m},
                     {"p_first_excess", worst->p_first_excess}};
  }
  return json;
}

std::vector<std::int64_t> tile_ids_of(JsonObject& object, const std::string& key) {
  std::vector<std::int64_t> ids;
  for (const Json& id : object.list(key)) {
    // A number beyond int64 wraps to a negative one.
    const bool ascending =
        id.is_number_integer() && id.get<std::int64_t>() >= 0 && (ids.empty() || id.get<std::int64_t>() > ids.back());
    if (!ascending) throw DataError(object.path(key) + ": " + id.dump() + " is not an ascending tile_id");
    ids.push_back(id.get<std::int64_t>());
  }
  return ids;
}

RouteProbability probability_from_json(JsonObject object) {
  RouteProbability probability;
  probability.p_within_limit = object.number("p_within_limit");
  probability.min_p_within_limit = object.number("min_p_within_limit");
  probability.expected_fixes = object.number("expected_fixes");
  probability.expected_false_fixes = object.number("expected_false_fixes");
  if (!object.value("worst").is_null()) {
    JsonObject worst = object.object("worst");
    probability.worst = WorstStretch{leg_index(worst), worst.number("from_distance_m"), worst.number("to_distance_m"),
                                     worst.number("p_first_excess")};
    worst.finish();
  }
  if (!object.value("interval").is_null()) {
    probability.interval = interval_from_json(object.object("interval"));
  }
  probability.level_tiles = object.number_or_nan("level_tiles");
  probability.level_age_months = object.number_or_nan("level_age_months");
  object.text("rests_on");  // follows from the rest
  object.finish();
  return probability;
}

Json loss_to_json(const LossAnywhere& loss) {
  Json json = {
      {"worst_distance_m", loss.points[loss.worst].distance_m}, {"step_m", loss.step_m}, {"points", Json::array()}};
  for (const LossPoint& point : loss.points) {
    json["points"].push_back({{"distance_m", point.distance_m},
                              {"leg", point.leg + 1},
                              {"max_error_m", point.max_error_m},
                              {"p_within_limit", json_number(point.p_within_limit)}});
  }
  return json;
}

Json ageing_to_json(const RouteAgeing& ageing) {
  const auto months = [](const std::optional<double>& up_to) { return up_to ? Json(*up_to) : Json(); };
  Json json = {{"enough_up_to_months", months(ageing.enough_up_to_months)},
               {"surely_up_to_months", months(ageing.surely_up_to_months)},
               {"ages", Json::array()}};
  for (const ChancesAtAge& at : ageing.ages) {
    json["ages"].push_back({{"age_months", at.age_months},
                            {"p_within_limit", at.p_within_limit},
                            {"interval", interval_to_json(at.interval)}});
  }
  return json;
}

RouteAgeing ageing_from_json(JsonObject object) {
  const auto age_of = [](JsonObject& at, const char* key) {
    const double age_months = at.number(key);
    if (age_months >= 0 && age_months <= kMostImageryAge_months) return age_months;
    throw DataError(at.path(key) + " = " + format_number(age_months) + " is no age of imagery");
  };
  const auto months = [&](const char* key) {
    return object.value(key).is_null() ? std::nullopt : std::optional(age_of(object, key));
  };
  RouteAgeing ageing;
  ageing.enough_up_to_months = months("enough_up_to_months");
  ageing.surely_up_to_months = months("surely_up_to_months");
  for (JsonObject& at : object.objects("ages")) {
    const double age_months = age_of(at, "age_months");
    const double p_within_limit = at.number("p_within_limit");
    ageing.ages.push_back({age_months, p_within_limit, interval_from_json(at.object("interval"))});
    at.finish();
  }
  if (ageing.ages.empty()) throw DataError(object.path("ages") + " is empty; the planned flight's is the first");
  object.finish();
  return ageing;
}

LossAnywhere loss_from_json(JsonObject object) {
  LossAnywhere loss;
  const double worst_m = object.number("worst_distance_m");
  loss.step_m = object.number("step_m");
  for (JsonObject& point : object.objects("points")) {
    loss.points.push_back({point.number("distance_m"), leg_index(point), point.number("max_error_m"),
                           point.number_or_nan("p_within_limit")});
    point.finish();
  }
  const auto worst = std::find_if(loss.points.begin(), loss.points.end(),
                                  [&](const LossPoint& point) { return point.distance_m == worst_m; });
  if (worst == loss.points.end()) {
    throw DataError(object.path("worst_distance_m") + " = " + format_number(worst_m) + " is none of its points");
  }
  loss.worst = static_cast<std::size_t>(worst - loss.points.begin());
  object.finish();
  return loss;
}

}  // namespace

std::string probability_text(double p) {
  return std::isnan(p) ? "–" : format_fixed(std::floor(p * 1000 + 1e-6) / 1000, 3);
}

std::string rests_on_text(const RouteProbability& probability) {
  if (probability.level_tiles > 0) {
    return "P rests on two dates of this ground, " + format_number(probability.level_tiles) +
           " tiles of which were judged, and takes the flight's day to differ as they do";
  }
  if (probability.level_tiles == 0) {
    return "P rests on one date of this ground: how often fixes come at this place, in that season, is taken from "
           "other places, which differ by as much as the interval says";
  }
  return "";
}

Json selection_to_json(const Selection& selection) {
  Json json = {{"pilotage_selection", kSelectionVersion},
               {"max_error_m", selection.max_error_m},
               {"sigma_multiple", selection.sigma_multiple},
               {"within_limit", selection.within_limit},
               {"matchable_fraction", selection.matchable_fraction},
               {"estimated_bytes", selection.estimated_bytes},
               {"probability", probability_to_json(selection.probability)},
               {"advice", Json::array()},
               {"notes", selection.notes},
               {"gaps", Json::array()},
               {"legs", Json::array()},
               {"error_profile", Json::array()},
               {"tile_ids", selection.tile_ids},
               {"left_out", nullptr}};
  if (const auto& left_out = selection.left_out) {
    json["left_out"] = {{"min_p_correct_fix", left_out->min_p_correct_fix},
                        {"min_peak_margin", left_out->min_peak_margin},
                        {"beyond_budget", left_out->beyond_budget}};
  }
  if (!selection.matchability_judged) json["matchability_judged"] = false;
  if (const auto& tries = selection.tries) {
    json["tries"] = {{"interval_s", tries->interval_s}, {"false_fix_rate", tries->false_fix_rate}};
    if (tries->decorrelation_m) json["tries"]["decorrelation_m"] = *tries->decorrelation_m;
  }
  if (selection.ageing) json["ageing"] = ageing_to_json(*selection.ageing);
  if (selection.loss_anywhere) json["loss_anywhere"] = loss_to_json(*selection.loss_anywhere);
  for (const LegAdvice& advice : selection.advice) {
    json["advice"].push_back({{"leg", advice.leg + 1},
                              {"side", side_name(advice.side)},
                              {"offset_m", advice.offset_m},
                              {"p_before", advice.p_before},
                              {"p_after", advice.p_after},
                              {"good", advice.good}});
  }
  for (const RouteGap& gap : selection.gaps) {
    json["gaps"].push_back({{"leg", gap.leg + 1},
                            {"from_distance_m", gap.from_distance_m},
                            {"to_distance_m", gap.to_distance_m},
                            {"duration_s", gap.duration_s},
                            {"error_m", gap.error_m},
                            {"within_limit", gap.within_limit},
                            {"p_first_excess", json_number(gap.p_first_excess)}});
  }
  for (const LegStatus& leg : selection.legs) {
    json["legs"].push_back({{"leg", leg.leg + 1},
                            {"length_m", leg.length_m},
                            {"matchable_fraction", leg.matchable_fraction},
                            {"max_error_m", leg.max_error_m},
                            {"within_limit", leg.within_limit},
                            {"p_within_limit", json_number(leg.p_within_limit)},
                            {"p_fix", json_number(leg.p_fix)}});
  }
  for (const ErrorSample& sample : selection.error_profile) {
    json["error_profile"].push_back({{"distance_m", sample.distance_m},
                                     {"error_m", sample.error_m},
                                     {"matchable", sample.matchable},
                                     {"p_correct_fix", json_number(sample.p_correct_fix)},
                                     {"p_within_limit", json_number(sample.p_within_limit)}});
  }
  return json;
}

Selection selection_from_json(const Json& json, const std::string& name) {
  JsonObject object(json, name);
  Selection selection;
  if (!object.has("pilotage_selection")) throw DataError(name + ": is not a selection; `pilotage select` makes one");
  if (const std::int64_t version = object.integer("pilotage_selection", 1); version != kSelectionVersion) {
    throw DataError(name + ": is a selection of version " + std::to_string(version) + ", this program reads " +
                    std::to_string(kSelectionVersion) + "; make it again with `pilotage select`");
  }
  selection.max_error_m = object.number("max_error_m");
  selection.sigma_multiple = object.number("sigma_multiple");
  selection.within_limit = object.boolean("within_limit");
  selection.matchable_fraction = object.number("matchable_fraction");
  selection.estimated_bytes = object.integer("estimated_bytes", 0);
  if (!object.value("probability").is_null()) {
    selection.probability = probability_from_json(object.object("probability"));
  }
  if (object.has("ageing")) selection.ageing = ageing_from_json(object.object("ageing"));
  if (object.has("loss_anywhere")) selection.loss_anywhere = loss_from_json(object.object("loss_anywhere"));
  for (JsonObject& advice : object.objects("advice")) {
    const int leg = leg_index(advice);
    const AdviceSide side = side_of(advice.text("side"), advice.path("side"));
    selection.advice.push_back({leg, side, advice.number("offset_m"), advice.number("p_before"),
                                advice.number("p_after"), advice.boolean("good")});
    advice.finish();
  }
  selection.notes = object.texts("notes");
  for (JsonObject& gap : object.objects("gaps")) {
    selection.gaps.push_back({leg_index(gap), gap.number("from_distance_m"), gap.number("to_distance_m"),
                              gap.number("duration_s"), gap.number("error_m"), gap.boolean("within_limit"),
                              gap.number_or_nan("p_first_excess")});
    gap.finish();
  }
  for (JsonObject& leg : object.objects("legs")) {
    selection.legs.push_back({leg_index(leg), leg.number("length_m"), leg.number("matchable_fraction"),
                              leg.number("max_error_m"), leg.boolean("within_limit"),
                              leg.number_or_nan("p_within_limit"), leg.number_or_nan("p_fix")});
    leg.finish();
  }
  for (JsonObject& sample : object.objects("error_profile")) {
    selection.error_profile.push_back({sample.number("distance_m"), sample.number("error_m"),
                                       sample.boolean("matchable"), sample.number_or_nan("p_correct_fix"),
                                       sample.number_or_nan("p_within_limit")});
    sample.finish();
  }
  selection.tile_ids = tile_ids_of(object, "tile_ids");
  if (!object.value("left_out").is_null()) {
    JsonObject left_out = object.object("left_out");
    selection.left_out = LeftOut{left_out.number("min_p_correct_fix"), left_out.number("min_peak_margin"),
                                 tile_ids_of(left_out, "beyond_budget")};
    left_out.finish();
  }
  if (object.has("matchability_judged")) selection.matchability_judged = object.boolean("matchability_judged");
  if (object.has("tries")) {
    JsonObject tries = object.object("tries");
    selection.tries = FixTries{};
    selection.tries->interval_s = tries.number("interval_s");
    if (tries.has("false_fix_rate")) selection.tries->false_fix_rate = tries.number("false_fix_rate");
    if (tries.has("decorrelation_m")) selection.tries->decorrelation_m = tries.number("decorrelation_m");
    tries.finish();
  }
  object.finish();
  return selection;
}

Selection read_selection(const std::filesystem::path& path) {
  return selection_from_json(parse_json(path.string(), read_file(path)), path.string());
}

}  // namespace pilotage
