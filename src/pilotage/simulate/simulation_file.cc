#include "pilotage/simulate/simulation_file.h"

#include <cmath>

#include <nlohmann/json.hpp>

#include "pilotage/base/json_object.h"
#include "pilotage/base/options_json.h"
#include "pilotage/base/text.h"
#include "pilotage/mission/selection.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

Json share_json(const SimulatedShare& share) {
  return {{"share", json_number(share.share())},
          {"flights", share.count},
          {"of", share.of},
          {"low", share.interval.low},
          {"high", share.interval.high}};
}

std::string share_text(const SimulatedShare& share) {
  if (share.of == 0) return "no flight came here";
  return probability_text(share.share()) + " [" + probability_text(share.interval.low) + ", " +
         probability_text(share.interval.high) + "]";
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

std::string marks_text(const Simulation& simulation) {
  std::string text;
  for (const SimulatedMark& mark : simulation.marks) {
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
    bins.push_back({{"mean_p", bin.mean_p},
                    {"tries", bin.found.of},
                    {"right", bin.found.count},
                    {"share", json_number(bin.found.share())},
                    {"low", bin.found.interval.low},
                    {"high", bin.found.interval.high}});
  }
  return bins;
}

Json rendered_json(const RenderedSummary& rendered) {
  const RenderedOptions& options = rendered.options;
  return {{"world", options.world},
          {"frame_width_px", options.frame_width_px},
          {"tilt_sigma_deg", options.tilt_sigma_deg},
          {"boresight_sigma_deg", options.boresight_sigma_deg},
          {"altimeter_sigma", options.altimeter_sigma},
          {"exposure_ms", options.exposure_ms},
          {"dropped_frames", options.dropped_frames},
          {"degradation", options.world.empty() ? options.degradation : 0},
          {"matches", to_json(rendered.matches, false)}};
}

std::string by_p_text(const Simulation& simulation) {
  std::string text;
  for (const SimulatedBin& bin : simulation.by_p) {
    text += "where P is " + probability_text(bin.mean_p) + ": right fixes of " + std::to_string(bin.found.of) +
            " tries " + share_text(bin.found) + "\n";
  }
  return text;
}

std::string sentences(const std::vector<std::string>& all) {
  std::string text;
  for (const std::string& sentence : all) text += (text.empty() ? "" : "; ") + sentence;
  return text;
}

}  // namespace

Json simulation_to_json(const Simulation& simulation) {
  const SimulateOptions& options = simulation.options;
  const TriedFixes& fixes = simulation.fixes;
  Json json = {{"pilotage_simulation", 1},
               {"fixes_from", options_detail::enum_to_name(options.fixes)},
               {"flights", simulation.flights},
               {"seed", simulation.seed},
               {"max_error_m", simulation.max_error_m},
               {"sigma_multiple", simulation.sigma_multiple},
               {"gnss_lost_from_m", simulation.lost_from_m},
               {"map_sigma_m", options.map_sigma_m},
               {"map_correlation_m", options.map_correlation_m},
               {"wind_sigma_mps", options.wind_sigma_mps},
               {"false_fix_rate", options.false_fix_rate},
               {"planned_p", json_number(simulation.planned_p)},
               {"within", share_json(simulation.within)},
               {"within_by_sigma", share_json(simulation.within_sure)},
               {"within_by_true_error", share_json(simulation.within_true)},
               {"off_unaware", share_json(simulation.unaware)},
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
               {"legs", Json::array()},
               {"along", Json::array()},
               {"notes", simulation.notes},
               {"not_simulated", simulation.not_simulated}};
  if (simulation.rendered) json["rendered"] = rendered_json(*simulation.rendered);
  for (const SimulatedLeg& leg : simulation.legs) {
    json["legs"].push_back(
        {{"leg", leg.leg}, {"planned_p", json_number(leg.planned_p)}, {"within", share_json(leg.within)}});
  }
  for (const SimulatedMark& mark : simulation.marks) {
    json["along"].push_back({{"distance_m", mark.distance_m},
                             {"p_within", mark.p_within},
                             {"lost", mark.lost},
                             {"cep50_m", json_number(mark.cep50_m)},
                             {"r95_m", json_number(mark.r95_m)},
                             {"nees", json_number(mark.nees)},
                             {"nees_low", mark.nees_band.low},
                             {"nees_high", mark.nees_band.high}});
  }
  return json;
}

std::string simulation_text(const Simulation& simulation) {
  const TriedFixes& fixes = simulation.fixes;
  std::string text = std::to_string(simulation.within.count) + " of " + std::to_string(simulation.flights) +
                     " flights stay within " + format_fixed(simulation.max_error_m, 0) +
                     " m all the way and know it: " + share_text(simulation.within) + ", planned " +
                     probability_text(simulation.planned_p) + "\n";
  text += "GNSS lost from " + format_fixed(simulation.lost_from_m / 1000, 2) + " km; intervals are of 95 %\n";
  text += "by " + format_number(simulation.sigma_multiple) +
          " sigma of the filter alone, as the plan counts: " + share_text(simulation.within_sure) +
          "; by the true error alone: " + share_text(simulation.within_true) +
          "; off without knowing: " + share_text(simulation.unaware) + "\n";
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
  if (simulation.rendered) text += evaluation_text(simulation.rendered->matches);
  if (!simulation.notes.empty()) text += "note: " + sentences(simulation.notes) + "\n";
  return text + "not simulated: " + sentences(simulation.not_simulated) + "\n";
}

}  // namespace pilotage
