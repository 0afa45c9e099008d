#include "pilotage/replay/replay_file.h"

#include <cmath>

#include <nlohmann/json.hpp>

#include "pilotage/base/json_object.h"
#include "pilotage/base/text.h"
#include "pilotage/evaluate/evaluation.h"
#include "pilotage/matchability/quality_report.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

Json flown_fixes_json(const TryCounts& fixes) {
  return {{"tries", fixes.tries},
          {"right", fixes.right},
          {"unjudged", fixes.unjudged},
          {"missed", fixes.missed},
          {"not_stored", fixes.not_stored},
          {"off_line", fixes.off_line},
          {"false_taken", fixes.false_taken},
          {"not_tried", fixes.not_tried}};
}

Json quantity_json(const FlownQuantity& quantity) {
  return {{"count", quantity.count},
          {"median", json_number(quantity.median)},
          {"p95_abs", json_number(quantity.p95_abs)},
          {"largest_abs", json_number(quantity.largest_abs)}};
}

Json prediction_json(const PredictedAgainstFlown& prediction) {
  Json quality = to_json(JudgedPredictor{predictor_columns().front(), "P(correct fix)", prediction.quality});
  quality.erase("bins");  // here as `reliability`
  Json bins = Json::array();
  for (const ReliabilityBin& bin : prediction.quality.bins) {
    Json row{{"low_p", bin.low}, {"high_p", bin.high}, {"mean_p", bin.mean_value}};
    row.update(share_to_json(bin.correct));
    bins.push_back(std::move(row));
  }
  return {{"tries", prediction.tries},
          {"too_unsure", prediction.too_unsure},
          {"observed", share_to_json(prediction.observed)},
          {"predicted", json_number(prediction.predicted)},
          {"large_z", json_number(prediction.large_z)},
          {"large_z_with_level", json_number(prediction.large_z_with_level)},
          {"reliability", std::move(bins)},
          {"quality", quality}};
}

Json leg_json(const FlownLeg& leg) {
  return {{"leg", leg.leg + 1},
          {"planned_p", json_number(leg.planned_p)},
          {"planned_p_fix", json_number(leg.planned_p_fix)},
          {"planned_max_error_m", json_number(leg.planned_max_error_m)},
          {"fixes", flown_fixes_json(leg.fixes)},
          {"predicted", json_number(leg.predicted)},
          {"observed", share_to_json(leg.observed)},
          {"errors", leg.errors},
          {"median_error_m", json_number(leg.median_error_m)},
          {"largest_error_m", json_number(leg.largest_error_m)}};
}

Json line_json(const FlownLine& line) {
  return {{"frames", line.frames},
          {"away", line.away},
          {"beyond_corridor", line.beyond_corridor},
          {"beyond_heights", line.beyond_heights},
          {"offset_m", quantity_json(line.offset_m)},
          {"height_error_m", quantity_json(line.height_error_m)},
          {"heading_error_deg", quantity_json(line.heading_error_deg)},
          {"speed_ratio", quantity_json(line.speed_ratio)}};
}

Json grade_json(const GradeFit& grade, const std::string& name) {
  const auto number = [](const std::optional<double>& value) { return value ? Json(*value) : Json(); };
  return {{"grade", name},
          {"innovations", grade.innovations},
          {"longest_gap_s", grade.longest_gap_s},
          {"nis", json_number(grade.mean_nis)},
          {"nis_low", json_number(grade.nis_band.low)},
          {"nis_high", json_number(grade.nis_band.high)},
          {"factor", number(grade.factor)},
          {"low", number(grade.low)},
          {"high", number(grade.high)},
          {"why_not", grade.why_not}};
}

Json contradictions_json(const Contradictions& contradictions) {
  Json suspects = Json::array();
  for (const Contradiction& suspect : contradictions.suspects) {
    suspects.push_back({{"tile_id", suspect.tile.tile_id},
                        {"center_lon_deg", suspect.tile.center.lon_deg},
                        {"center_lat_deg", suspect.tile.center.lat_deg},
                        {"p", suspect.tile.p},
                        {"passes", suspect.tile.passes},
                        {"won", suspect.tile.won},
                        {"chance", suspect.chance},
                        {"refresh", suspect.refresh}});
  }
  return {{"tiles", contradictions.tiles},
          {"false_discovery_rate", kFalseDiscoveryRate},
          {"expected_suspects", contradictions.expected_below_5_percent},
          {"suspects", std::move(suspects)}};
}

std::string percent_text(double share) {
  return std::isnan(share) ? "–" : format_fixed(100 * share, 1) + " %";
}

std::string flown_share_text(const Share& share) {
  if (share.of == 0) return "none";
  const Interval interval = share.interval();
  return std::to_string(share.count) + " of " + std::to_string(share.of) + ": " + percent_text(share.value()) + " [" +
         format_fixed(100 * interval.low, 1) + ", " + format_fixed(100 * interval.high, 1) + "]";
}

std::string number_text(double value, int decimals) {
  return std::isnan(value) ? "–" : format_fixed(value, decimals);
}

std::string fixes_text(const Replay& replay) {
  const TryCounts& fixes = replay.fixes;
  std::string text = std::to_string(fixes.tries) + " tries: ";
  if (replay.has_truth) text += "right " + std::to_string(fixes.right) + ", ";
  if (fixes.unjudged > 0) text += "fixes without truth " + std::to_string(fixes.unjudged) + ", ";
  text += "missed " + std::to_string(fixes.missed) + ", over ground not stored " + std::to_string(fixes.not_stored) +
          ", beside the line " + std::to_string(fixes.off_line) + ", false " + std::to_string(fixes.false_taken);
  if (fixes.not_tried > 0) text += "; not tried " + std::to_string(fixes.not_tried);
  text += "\n";
  if (!std::isnan(replay.median_error_m)) {
    text += "error of fixes: median " + number_text(replay.median_error_m, 2) + " m, 95 % below " +
            number_text(replay.p95_error_m, 2) + " m; NEES of right ones " + number_text(replay.nees.mean, 2) +
            " in [" + number_text(replay.nees.band.low, 2) + ", " + number_text(replay.nees.band.high, 2) + "]\n";
  }
  return text;
}

std::string prediction_text(const PredictedAgainstFlown& prediction) {
  const PredictionQuality& quality = prediction.quality;
  std::string text = "fixes over stored tiles: " + flown_share_text(prediction.observed) + ", predicted " +
                     percent_text(prediction.predicted) + "\n";
  if (prediction.too_unsure > 0) {
    text += "not counted, for P is of surer priors: " + std::to_string(prediction.too_unsure) + " tries\n";
  }
  text += "in the large: " + number_text(prediction.large_z, 2) + " sigma were tries independent, " +
          number_text(prediction.large_z_with_level, 2) + " with the level of the place\n";
  text += "P of the tiles: AUC " + estimate_text(quality.auc, 3) + ", Brier skill " +
          estimate_text(quality.brier_skill, 3) + ", calibration error " + estimate_text(quality.calibration_error, 3) +
          " (by chance " + number_text(quality.chance_calibration_error, 3) + ")\n";
  for (const ReliabilityBin& bin : quality.bins) {
    text += "  P " + format_fixed(bin.low, 2) + " … " + format_fixed(bin.high, 2) + ": predicted " +
            percent_text(bin.mean_value) + ", flown " + flown_share_text(bin.correct) + "\n";
  }
  return text;
}

std::string leg_text(const FlownLeg& leg) {
  std::string text = "leg " + std::to_string(leg.leg + 1) + ": ";
  if (leg.fixes.tries == 0) return text + "not flown\n";
  text += std::to_string(leg.fixes.right + leg.fixes.unjudged) + " fixes of " + std::to_string(leg.fixes.tries) +
          " tries, missed " + std::to_string(leg.fixes.missed) + ", false " + std::to_string(leg.fixes.false_taken) +
          "; over stored tiles " + percent_text(leg.observed.value()) + ", predicted " + percent_text(leg.predicted);
  if (leg.errors > 0) text += "; largest error " + number_text(leg.largest_error_m, 1) + " m";
  return text + "; planned P " + number_text(leg.planned_p, 3) + "\n";
}

std::string line_text(const FlownLine& line) {
  std::string text = "line: " + std::to_string(line.frames) + " frames on it, " + std::to_string(line.away) +
                     " away; offset median " + number_text(line.offset_m.median, 1) + " m, 95 % below " +
                     number_text(line.offset_m.p95_abs, 1) + " m, beyond the corridor " +
                     std::to_string(line.beyond_corridor) + "\n";
  text += "height: median " + number_text(line.height_error_m.median, 1) + " m beside the plan, largest " +
          number_text(line.height_error_m.largest_abs, 1) + " m, at no level's height " +
          std::to_string(line.beyond_heights) + "; heading: 95 % within " +
          number_text(line.heading_error_deg.p95_abs, 1) + "°";
  if (line.speed_ratio.count > 0) text += "; speed: median " + number_text(line.speed_ratio.median, 2) + " of planned";
  return text + "\n";
}

std::string grade_text(const GradeFit& grade, const std::string& name) {
  if (!grade.factor) return "inertial system: " + grade.why_not + "\n";
  const auto end = [](const std::optional<double>& value) { return value ? format_fixed(*value, 2) : "?"; };
  return "inertial system: behaves like " + format_fixed(*grade.factor, 2) + " × " + name + " [" + end(grade.low) +
         ", " + end(grade.high) + "], from " + std::to_string(grade.innovations) + " gaps of up to " +
         format_fixed(grade.longest_gap_s, 0) + " s; NIS " + number_text(grade.mean_nis, 2) + " in [" +
         number_text(grade.nis_band.low, 2) + ", " + number_text(grade.nis_band.high, 2) + "]\n";
}

std::string contradictions_text(const Contradictions& contradictions) {
  std::int64_t refresh = 0;
  for (const Contradiction& suspect : contradictions.suspects) refresh += suspect.refresh ? 1 : 0;
  std::string text = "tiles that contradict their P: " + std::to_string(refresh) + " of " +
                     std::to_string(contradictions.tiles) + "; suspects at 5 % " +
                     std::to_string(contradictions.suspects.size()) + ", by chance " +
                     format_fixed(contradictions.expected_below_5_percent, 1) + "\n";
  for (const Contradiction& suspect : contradictions.suspects) {
    if (!suspect.refresh) continue;
    text += "  tile " + std::to_string(suspect.tile.tile_id) + ": P " + format_fixed(suspect.tile.p, 2) + ", " +
            std::to_string(suspect.tile.won) + " of " + std::to_string(suspect.tile.passes) + " passes gave a fix\n";
  }
  return text;
}

}  // namespace

Json replay_to_json(const Replay& replay) {
  Json json{{"pilotage_replay", 1},
            {"flights", replay.flights},
            {"priors", replay.priors},
            {"has_truth", replay.has_truth},
            {"correct_within_m", replay.correct_within_m},
            {"max_prior_sigma_m", replay.max_prior_sigma_m ? Json(*replay.max_prior_sigma_m) : Json()},
            {"planned_p", replay.planned_p ? json_number(*replay.planned_p) : Json()},
            {"fixes", flown_fixes_json(replay.fixes)},
            {"integrity", replay.integrity ? integrity_to_json(*replay.integrity) : Json()},
            {"median_error_m", json_number(replay.median_error_m)},
            {"p95_error_m", json_number(replay.p95_error_m)},
            {"nees", json_number(replay.nees.mean)},
            {"nees_low", json_number(replay.nees.band.low)},
            {"nees_high", json_number(replay.nees.band.high)},
            {"prediction", replay.prediction ? prediction_json(*replay.prediction) : Json()},
            {"legs", Json::array()},
            {"line", replay.line ? line_json(*replay.line) : Json()},
            {"inertial", replay.grade ? grade_json(*replay.grade, replay.grade_name) : Json()},
            {"contradictions", contradictions_json(replay.contradictions)},
            {"notes", replay.notes}};
  for (const FlownLeg& leg : replay.legs) json["legs"].push_back(leg_json(leg));
  return json;
}

std::string replay_text(const Replay& replay) {
  std::string text = fixes_text(replay);
  if (replay.prediction) text += prediction_text(*replay.prediction);
  if (replay.integrity && replay.integrity->looked > 0) text += integrity_text(*replay.integrity) + "\n";
  for (const FlownLeg& leg : replay.legs) text += leg_text(leg);
  if (replay.line) text += line_text(*replay.line);
  if (replay.grade) text += grade_text(*replay.grade, replay.grade_name);
  if (replay.prediction) text += contradictions_text(replay.contradictions);
  return text;
}

}  // namespace pilotage
