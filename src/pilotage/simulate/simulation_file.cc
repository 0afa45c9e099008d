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
  return "the same flights with nothing but what the plan knows: " + share_text(planned->within) +
         "; wind, the map's error and false fixes cost " + format_fixed(planned->cost, 3) + " [" +
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
               {"as_planned", as_planned_json(simulation.as_planned)},
               {"lost_at", Json::array()},
               {"fixes",
                {{"tries", fixes.tries},
                 {"right", fixes.right},
                 {"missed", fixes.missed},
                 {"not_stored", fixes.not_stored},
                 {"off_line", fixes.off_line},
                 {"false_taken", fixes.false_taken},
                 {"refused", fixes.refused},
                 {"resets", fixes.resets}}},
               {"legs", Json::array()},
               {"along", Json::array()},
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
        {{"leg", leg.leg}, {"planned_p", json_number(leg.planned_p)}, {"within", share_json(leg.within)}});
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
  const TriedFixes& fixes = simulation.fixes;
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
  text += cost_text(simulation.as_planned);
  text += legs_text(simulation);
  text += marks_text(simulation);
  text += "of " + per_flight(fixes.tries, simulation) + " tries a flight: right " +
          per_flight(fixes.right, simulation) + ", missed " + per_flight(fixes.missed, simulation) +
          ", over ground not stored " + per_flight(fixes.not_stored, simulation) + ", beside the line " +
          per_flight(fixes.off_line, simulation) + "; false ones taken " +
          format_number(static_cast<double>(fixes.false_taken)) + ", refused " +
          format_number(static_cast<double>(fixes.refused)) + ", resets " +
          format_number(static_cast<double>(fixes.resets)) + " in all\n";
  text += "not simulated: ";
  for (std::size_t i = 0; i < simulation.not_simulated.size(); ++i) {
    text += (i > 0 ? "; " : "") + simulation.not_simulated[i];
  }
  return text + "\n";
}

}  // namespace pilotage
