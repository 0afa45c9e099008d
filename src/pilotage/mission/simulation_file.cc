#include "pilotage/mission/simulation_file.h"

#include <cmath>

#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/options_json.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/mission/selection.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kSimulationVersion = 2;
constexpr int kMostLegs = 1'000'000;

Json share_json(const Share& share) {
  const Interval interval = share.interval();
  return {{"share", json_number(share.value())},
          {"flights", share.count},
          {"of", share.of},
          {"low", interval.low},
          {"high", interval.high}};
}

/// Null where flights do not bound it.
Json ellipse_json(const TruePlaceEllipse& ellipse) {
  if (std::isnan(ellipse.major_m)) return nullptr;
  return {{"major_m", ellipse.major_m}, {"minor_m", ellipse.minor_m}, {"azimuth_deg", ellipse.azimuth_deg}};
}

Json as_planned_json(const std::optional<AsPlanned>& planned) {
  if (!planned) return nullptr;
  return {{"within", share_json(planned->within)},
          {"cost", planned->cost},
          {"cost_low", planned->cost_interval.low},
          {"cost_high", planned->cost_interval.high}};
}

std::string error_text(double error_m) {
  return std::isnan(error_m) ? "–" : format_fixed(error_m, 1);
}

std::string per_flight(std::int64_t sum, const Simulation& simulation) {
  return format_fixed(static_cast<double>(sum) / static_cast<double>(simulation.flights), 2);
}

std::string legs_text(const Simulation& simulation) {
  std::string text;
  for (const SimulatedLeg& leg : simulation.legs) {
    text += "leg " + std::to_string(leg.leg + 1) + ": planned " + probability_text(leg.planned_p) + ", simulated " +
            share_text(leg.within) + "\n";
  }
  return text;
}

std::string losses_text(const Simulation& simulation) {
  std::string text;
  for (const SimulatedLoss& loss : simulation.losses) {
    text += "lost for good at " + format_fixed(loss.lost_from_m / 1000, 2) + " km: planned " +
            probability_text(loss.planned_p) + ", simulated " + share_text(loss.within) +
            (loss.lost_from_m == simulation.lost_from_m ? ", the worst place: all that follows is of it" : "") + "\n";
  }
  return text;
}

std::string cost_text(const std::optional<AsPlanned>& planned) {
  if (!planned) return "";
  return "the same flights in the plan's own conditions: " + share_text(planned->within) +
         "; those given instead cost " + format_fixed(planned->cost, 3) + " [" +
         format_fixed(planned->cost_interval.low, 3) + ", " + format_fixed(planned->cost_interval.high, 3) + "]\n";
}

/// At whole kilometres and at the end.
std::string marks_text(const Simulation& simulation) {
  std::string text;
  for (const SimulatedMark& mark : simulation.marks) {
    const bool whole = std::abs(std::remainder(mark.distance_m, 1000)) < 1e-6;
    if (!whole && &mark != &simulation.marks.back()) continue;
    text += "at " + format_fixed(mark.distance_m / 1000, 2) + " km: within the limit " +
            probability_text(mark.p_within) + ", CEP50 " + error_text(mark.cep50_m) + " m, R95 " +
            error_text(mark.r95_m) + " m, NEES " + format_fixed(mark.nees, 2) + " in [" +
            format_fixed(mark.nees_band.low, 2) + ", " + format_fixed(mark.nees_band.high, 2) + "]\n";
  }
  return text;
}

Json by_p_json(const Simulation& simulation) {
  Json bins = Json::array();
  for (const SimulatedBin& bin : simulation.by_p) {
    const Interval interval = bin.found.interval();
    bins.push_back({{"mean_p", bin.mean_p},
                    {"tries", bin.found.of},
                    {"right", bin.found.count},
                    {"share", json_number(bin.found.value())},
                    {"low", interval.low},
                    {"high", interval.high}});
  }
  return bins;
}

std::string by_p_text(const Simulation& simulation) {
  std::string text;
  for (const SimulatedBin& bin : simulation.by_p) {
    text += "where P is " + probability_text(bin.mean_p) + ": right fixes of " + std::to_string(bin.found.of) +
            " tries " + share_text(bin.found) + "\n";
  }
  return text;
}

SimulatedBin read_bin(JsonObject& json) {
  const double mean_p = json.number("mean_p");
  const std::int64_t right = json.integer("right", 0);
  const std::int64_t tries = json.integer("tries", right);
  for (const char* key : {"share", "low", "high"}) json.number_or_nan(key);
  json.finish();
  return {mean_p, {right, tries}};
}

Share read_share(JsonObject json) {
  json.number_or_nan("share");
  const std::int64_t count = json.integer("flights", 0);
  const std::int64_t of = json.integer("of", count);
  json.number("low");
  json.number("high");
  json.finish();
  return {count, of};  // its interval is a function of both
}

TruePlaceEllipse read_ellipse(JsonObject& mark) {
  if (!mark.has_value("true_place")) return {kNaN, kNaN, kNaN};
  JsonObject json = mark.object("true_place");
  const TruePlaceEllipse ellipse{json.number("major_m"), json.number("minor_m"), json.number("azimuth_deg")};
  json.finish();
  return ellipse;
}

SimulatedMark read_mark(JsonObject& json) {
  SimulatedMark mark;
  mark.distance_m = json.number("distance_m");
  mark.planned_time_s = json.number("planned_time_s");
  mark.p_within = json.number("p_within");
  mark.lost = json.integer("lost", 0);
  mark.cep50_m = json.number_or_nan("cep50_m");
  mark.r95_m = json.number_or_nan("r95_m");
  mark.nees = json.number_or_nan("nees");
  mark.nees_band = {json.number("nees_low"), json.number("nees_high")};
  mark.true_place = read_ellipse(json);
  json.finish();
  return mark;
}

TryCounts read_fixes(JsonObject json) {
  TryCounts fixes;
  const auto count = [&](const char* key) { return json.integer(key, 0); };
  fixes.tries = count("tries");
  fixes.right = count("right");
  fixes.missed = count("missed");
  fixes.not_stored = count("not_stored");
  fixes.off_line = count("off_line");
  fixes.no_frame = count("no_frame");
  fixes.false_taken = count("false_taken");
  fixes.refused = count("refused");
  fixes.resets = count("resets");
  json.finish();
  return fixes;
}

std::optional<AsPlanned> read_as_planned(JsonObject& object) {
  if (!object.has_value("as_planned")) return {};
  JsonObject json = object.object("as_planned");
  AsPlanned planned;
  planned.within = read_share(json.object("within"));
  planned.cost = json.number("cost");
  planned.cost_interval = {json.number("cost_low"), json.number("cost_high")};
  json.finish();
  return planned;
}

void read_lists(JsonObject& object, Simulation& simulation) {
  for (JsonObject& json : object.objects("lost_at")) {
    simulation.losses.push_back(
        {json.number("distance_m"), json.number_or_nan("planned_p"), read_share(json.object("within"))});
    json.finish();
  }
  for (JsonObject& json : object.objects("legs")) {
    const int leg = json.small_integer("leg", 1, kMostLegs) - 1;
    simulation.legs.push_back({leg, json.number_or_nan("planned_p"), read_share(json.object("within"))});
    json.finish();
  }
  for (JsonObject& json : object.objects("by_p")) simulation.by_p.push_back(read_bin(json));
  for (JsonObject& json : object.objects("along")) simulation.marks.push_back(read_mark(json));
  for (JsonObject& json : object.objects("inputs")) {
    simulation.inputs.push_back({json.text("role"), "", "", json.text("digest")});
    json.finish();
  }
}

}  // namespace

std::string share_text(const Share& share) {
  if (share.of == 0) return "no flight came here";
  const Interval interval = share.interval();
  return probability_text(share.value()) + " [" + probability_text(interval.low) + ", " +
         probability_text(interval.high) + "]";
}

Simulation simulation_from_json(const Json& json, const std::string& name) {
  JsonObject object(json, name);
  if (!json.contains("pilotage_simulation")) {
    throw DataError(name + ": is no simulation; `pilotage simulate` writes simulation.json");
  }
  const std::int64_t version = object.integer("pilotage_simulation");
  if (version != kSimulationVersion) {
    throw DataError(name + ": is of version " + std::to_string(version) + ", this program knows " +
                    std::to_string(kSimulationVersion) + "; simulate again");
  }
  Simulation simulation;
  object.text("fixes_from");
  simulation.flights = object.integer("flights", 1);
  simulation.seed = static_cast<std::uint64_t>(object.integer("seed", 0));
  simulation.options = object.value("options");
  simulation.max_error_m = object.number("max_error_m");
  simulation.sigma_multiple = object.number("sigma_multiple");
  simulation.lost_from_m = object.number("gnss_lost_from_m");
  simulation.planned_p = object.number_or_nan("planned_p");
  simulation.within = read_share(object.object("within"));
  simulation.within_sure = read_share(object.object("within_by_sigma"));
  simulation.within_true = read_share(object.object("within_by_true_error"));
  simulation.unaware = read_share(object.object("off_unaware"));
  simulation.integrity = integrity_from_json(object.object("integrity"));
  simulation.as_planned = read_as_planned(object);
  simulation.fixes = read_fixes(object.object("fixes"));
  read_lists(object, simulation);
  simulation.rendered = object.value("rendered");
  simulation.notes = object.texts("notes");
  simulation.not_simulated = object.texts("not_simulated");
  object.finish();
  return simulation;
}

std::vector<InputFile> simulated_inputs(const std::string& plan, const std::string& table,
                                        const std::string& selection) {
  return {input_file("plan", plan, ""), input_file("table", table, ""), input_file("selection", selection, "")};
}

Simulation read_simulation(const std::filesystem::path& path) {
  return simulation_from_json(parse_json(path.string(), read_file(path)), path.string());
}

Json simulation_to_json(const Simulation& simulation) {
  const TryCounts& fixes = simulation.fixes;
  Json json = {{"pilotage_simulation", kSimulationVersion},
               {"fixes_from", simulation.options.value("fixes", "drawn")},
               {"flights", simulation.flights},
               {"seed", simulation.seed},
               {"max_error_m", simulation.max_error_m},
               {"sigma_multiple", simulation.sigma_multiple},
               {"gnss_lost_from_m", simulation.lost_from_m},
               {"options", simulation.options},
               {"planned_p", json_number(simulation.planned_p)},
               {"within", share_json(simulation.within)},
               {"within_by_sigma", share_json(simulation.within_sure)},
               {"within_by_true_error", share_json(simulation.within_true)},
               {"off_unaware", share_json(simulation.unaware)},
               {"integrity", integrity_to_json(simulation.integrity)},
               {"as_planned", as_planned_json(simulation.as_planned)},
               {"lost_at", Json::array()},
               {"fixes",
                {{"tries", fixes.tries},
                 {"right", fixes.right},
                 {"missed", fixes.missed},
                 {"not_stored", fixes.not_stored},
                 {"off_line", fixes.off_line},
                 {"no_frame", fixes.no_frame},
                 {"false_taken", fixes.false_taken},
                 {"refused", fixes.refused},
                 {"resets", fixes.resets}}},
               {"by_p", by_p_json(simulation)},
               {"rendered", simulation.rendered},
               {"legs", Json::array()},
               {"along", Json::array()},
               {"notes", simulation.notes},
               {"not_simulated", simulation.not_simulated},
               {"inputs", Json::array()}};
  for (const SimulatedLoss& loss : simulation.losses) {
    json["lost_at"].push_back({{"distance_m", loss.lost_from_m},
                               {"planned_p", json_number(loss.planned_p)},
                               {"within", share_json(loss.within)}});
  }
  // Without names: a simulation has the same bytes wherever its files lie.
  for (const InputFile& input : simulation.inputs) {
    json["inputs"].push_back({{"role", input.role}, {"digest", input.digest}});
  }
  for (const SimulatedLeg& leg : simulation.legs) {
    json["legs"].push_back(
        {{"leg", leg.leg + 1}, {"planned_p", json_number(leg.planned_p)}, {"within", share_json(leg.within)}});
  }
  for (const SimulatedMark& mark : simulation.marks) {
    json["along"].push_back({{"distance_m", mark.distance_m},
                             {"planned_time_s", mark.planned_time_s},
                             {"p_within", mark.p_within},
                             {"lost", mark.lost},
                             {"cep50_m", json_number(mark.cep50_m)},
                             {"r95_m", json_number(mark.r95_m)},
                             {"nees", json_number(mark.nees)},
                             {"nees_low", mark.nees_band.low},
                             {"nees_high", mark.nees_band.high},
                             {"true_place", ellipse_json(mark.true_place)}});
  }
  return json;
}

std::string simulation_text(const Simulation& simulation) {
  const TryCounts& fixes = simulation.fixes;
  std::string text = std::to_string(simulation.within.count) + " of " + std::to_string(simulation.flights) +
                     " flights stay within " + format_fixed(simulation.max_error_m, 0) +
                     " m all the way and know it: " + share_text(simulation.within) + ", planned " +
                     probability_text(simulation.planned_p) + "\n";
  text += losses_text(simulation);
  text += "GNSS lost from " + format_fixed(simulation.lost_from_m / 1000, 2) + " km; intervals are of 95 %\n";
  text += "by " + format_number(simulation.sigma_multiple) +
          " sigma of the filter alone, as the plan counts: " + share_text(simulation.within_sure) +
          "; by the true error alone: " + share_text(simulation.within_true) +
          "; off without knowing: " + share_text(simulation.unaware) + "\n";
  text += integrity_text(simulation.integrity) + "\n";
  text += cost_text(simulation.as_planned);
  text += legs_text(simulation);
  text += marks_text(simulation);
  text += "of " + per_flight(fixes.tries, simulation) + " tries a flight: right " +
          per_flight(fixes.right, simulation) + ", missed " + per_flight(fixes.missed, simulation) +
          ", over ground not stored " + per_flight(fixes.not_stored, simulation) + ", beside the line " +
          per_flight(fixes.off_line, simulation) + ", without a frame " + per_flight(fixes.no_frame, simulation) +
          "; false ones taken " + format_number(static_cast<double>(fixes.false_taken)) + ", refused " +
          format_number(static_cast<double>(fixes.refused)) + ", resets " +
          format_number(static_cast<double>(fixes.resets)) + " in all\n";
  text += by_p_text(simulation);
  if (!simulation.notes.empty()) text += "note: " + join(simulation.notes, "; ") + "\n";
  return text + "not simulated: " + join(simulation.not_simulated, "; ") + "\n";
}

}  // namespace pilotage
