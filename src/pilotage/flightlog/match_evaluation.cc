#include "pilotage/flightlog/match_evaluation.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kConfidence = 0.95;

/// Covariances that cannot be inverted have no NEES and are left out.
NeesSummary summarise_nees(const std::vector<double>& all) {
  NeesSummary summary{0, kNaN, {kNaN, kNaN}};
  double sum = 0;
  for (const double nees : all) {
    if (std::isnan(nees)) continue;
    ++summary.count;
    sum += nees;
  }
  if (summary.count == 0) return summary;
  const auto count = static_cast<double>(summary.count);
  summary.mean = sum / count;
  summary.band = {chi_squared_quantile((1 - kConfidence) / 2, 2 * count) / count,
                  chi_squared_quantile((1 + kConfidence) / 2, 2 * count) / count};
  return summary;
}

Json nees_json(const NeesSummary& nees) {
  return {{"count", nees.count},
          {"mean", json_number(nees.mean)},
          {"band_low", json_number(nees.band.low)},
          {"band_high", json_number(nees.band.high)}};
}

Json sequence_json(const SequenceSummary& sequence) {
  return {{"narrowed", sequence.narrowed},
          {"confirmed", sequence.confirmed},
          {"gate_refusals", sequence.gate_refusals},
          {"resets", sequence.resets},
          {"rows_jump", sequence.rows_jump}};
}

std::string sequence_text(const SequenceSummary& sequence) {
  return (sequence.rows_jump ? "not in sequence, for the priors are no one system's; tried: " : "in sequence: ") +
         std::to_string(sequence.narrowed) + " priors narrowed, " + std::to_string(sequence.confirmed) +
         " fixes by confirmation, " + std::to_string(sequence.gate_refusals) + " against the track, " +
         std::to_string(sequence.resets) + " tracks given up\n";
}

std::string rate_text(const Share& rate, const std::string& of_what) {
  const auto percent = [](double share) { return format_fixed(100 * share, 2); };
  const Interval interval = rate.interval();
  return (rate.of == 0 ? "undefined" : percent(rate.value()) + " %") + " (" + std::to_string(rate.count) + " of " +
         std::to_string(rate.of) + " " + of_what + "; 95 % interval " + percent(interval.low) + " to " +
         percent(interval.high) + " %)\n";
}

std::string nees_text(const NeesSummary& nees) {
  if (nees.count == 0) return "undefined\n";
  return format_fixed(nees.mean, 2) + ", " + (nees.inside() ? "inside" : "outside") + " the 95 % band " +
         format_fixed(nees.band.low, 2) + " to " + format_fixed(nees.band.high, 2) + " of " +
         std::to_string(nees.count) + " honest ones\n";
}

/// Of the fixes whose two points are known.
std::optional<MatchEvaluation::Centers> summarise_centers(std::span<const FrameMatch> matches, double within_m) {
  std::vector<double> errors_m;
  std::vector<double> nees;
  for (const FrameMatch& match : matches) {
    if (!match.center_error || !match.frame.true_nadir) continue;
    errors_m.push_back(match.center_error->error_m);
    nees.push_back(match.center_error->nees);
  }
  if (errors_m.empty()) return std::nullopt;
  MatchEvaluation::Centers centers;
  centers.fixes = static_cast<std::int64_t>(errors_m.size());
  centers.within = std::count_if(errors_m.begin(), errors_m.end(), [&](double error) { return error <= within_m; });
  centers.median_error_m = quantile(errors_m, 0.5);
  centers.p95_error_m = quantile(errors_m, 0.95);
  centers.nees = summarise_nees(nees);
  return centers;
}

Json centers_json(const MatchEvaluation::Centers& centers) {
  return {{"fixes", centers.fixes},
          {"within", centers.within},
          {"median_error_m", json_number(centers.median_error_m)},
          {"p95_error_m", json_number(centers.p95_error_m)},
          {"nees", nees_json(centers.nees)}};
}

std::string judged_text(const MatchEvaluation& evaluation) {
  if (evaluation.judged_at_center == 0) return "judged by the aircraft's own place, straight below it\n";
  const bool all = evaluation.judged_at_center == evaluation.frames_with_truth;
  return "judged by the ground at the centre of the image" +
         (all ? std::string() : " for " + std::to_string(evaluation.judged_at_center) + " frames") +
         ": the aircraft's own place (true_nadir_lon_deg), which tilt moves, is not known\n";
}

std::string fixes_by_map_text(const std::vector<std::int64_t>& fixes) {
  std::string text;
  for (const std::int64_t of_map : fixes) text += (text.empty() ? "" : ", ") + std::to_string(of_map);
  return "fixes of each map, in the order given: " + text + "\n";
}

std::string centers_text(const MatchEvaluation::Centers& centers, const std::string& limit) {
  return "at the centre of the image: " + std::to_string(centers.within) + " of " + std::to_string(centers.fixes) +
         " fixes within " + limit + ", median " + format_fixed(centers.median_error_m, 2) + " m, 95 % below " +
         format_fixed(centers.p95_error_m, 2) + " m, mean normalised error squared " + nees_text(centers.nees);
}

}  // namespace

MatchEvaluation evaluate_matches(std::span<const FrameMatch> matches, double correct_within_m,
                                 const MatchOptions& options) {
  if (!(correct_within_m > 0)) {
    throw UsageError("correct_within_m = " + format_number(correct_within_m) + " is not above 0");
  }
  MatchEvaluation evaluation;
  evaluation.frames = static_cast<std::int64_t>(matches.size());
  evaluation.correct_within_m = correct_within_m;
  std::vector<double> errors_m;
  std::vector<double> nees;
  std::vector<double> nees_correct;
  std::vector<double> times_ms;
  for (const FrameMatch& match : matches) {
    if (!match.readable()) ++evaluation.unreadable;
    const std::size_t maps = match.result.map_statuses.size();
    if (evaluation.fixes_by_map.size() < maps) evaluation.fixes_by_map.resize(maps);
    if (match.has_fix()) {
      ++evaluation.accepted;
      if (match.result.map_index < maps) ++evaluation.fixes_by_map[match.result.map_index];
    } else {
      ++evaluation.refused[frame_status_name(match)];
    }
    if (match.frame.truth()) ++evaluation.frames_with_truth;
    if (match.frame.truth() && !match.frame.true_nadir) ++evaluation.judged_at_center;
    if (!std::isnan(match.milliseconds)) times_ms.push_back(match.milliseconds);
    if (!match.error) continue;
    errors_m.push_back(match.error->error_m);
    nees.push_back(match.error->nees);
    if (match.error->error_m <= correct_within_m) nees_correct.push_back(match.error->nees);
  }
  const auto judged = static_cast<std::int64_t>(errors_m.size());
  const auto correct = static_cast<std::int64_t>(nees_correct.size());
  evaluation.correct = {correct, evaluation.frames_with_truth};
  evaluation.false_fixes = {judged - correct, judged};
  evaluation.median_error_m = quantile(errors_m, 0.5);
  evaluation.p95_error_m = quantile(errors_m, 0.95);
  evaluation.nees = summarise_nees(nees);
  evaluation.nees_correct = summarise_nees(nees_correct);
  evaluation.centers = summarise_centers(matches, correct_within_m);
  evaluation.lean = lean_of_fixes(matches, options);
  evaluation.median_ms = quantile(times_ms, 0.5);
  evaluation.p95_ms = quantile(times_ms, 0.95);
  return evaluation;
}

Json to_json(const MatchEvaluation& evaluation, bool timings) {
  Json json{{"frames", evaluation.frames},
            {"unreadable", evaluation.unreadable},
            {"accepted", evaluation.accepted},
            {"fixes_by_map", evaluation.fixes_by_map},
            {"refused", Json::object()}};
  for (const auto& [status, count] : evaluation.refused) json["refused"][status] = count;
  if (evaluation.sequence) json["sequence"] = sequence_json(*evaluation.sequence);
  json["lean"] = to_json(evaluation.lean);
  json["frames_with_truth"] = evaluation.frames_with_truth;
  if (evaluation.frames_with_truth > 0) {
    json["judged_at_center"] = evaluation.judged_at_center;
    json["correct_within_m"] = evaluation.correct_within_m;
    json["correct_fixes"] = share_to_json(evaluation.correct);
    json["false_fixes"] = share_to_json(evaluation.false_fixes);
    json["median_error_m"] = json_number(evaluation.median_error_m);
    json["p95_error_m"] = json_number(evaluation.p95_error_m);
    json["nees"] = nees_json(evaluation.nees);
    json["nees_correct"] = nees_json(evaluation.nees_correct);
    json["centers"] = evaluation.centers ? centers_json(*evaluation.centers) : Json(nullptr);
  }
  if (timings) {
    json["median_ms"] = json_number(evaluation.median_ms);
    json["p95_ms"] = json_number(evaluation.p95_ms);
  }
  return json;
}

std::string evaluation_text(const MatchEvaluation& evaluation, bool timings) {
  std::string text = std::to_string(evaluation.frames) + " frames, " + std::to_string(evaluation.accepted) + " fixes\n";
  if (evaluation.fixes_by_map.size() > 1) text += fixes_by_map_text(evaluation.fixes_by_map);
  for (const auto& [status, count] : evaluation.refused) {
    text += "  " + std::to_string(count) + " " + status + "\n";
  }
  if (evaluation.sequence) text += sequence_text(*evaluation.sequence);
  const std::string limit = format_number(evaluation.correct_within_m) + " m";
  if (evaluation.frames_with_truth > 0) {
    text += judged_text(evaluation);
    text += "correct fixes, within " + limit + ": " + rate_text(evaluation.correct, "frames");
    text += "false fixes, beyond " + limit + ": " + rate_text(evaluation.false_fixes, "fixes");
  }
  if (evaluation.false_fixes.of > 0) {
    text += "error: median " + format_fixed(evaluation.median_error_m, 2) + " m, 95 % below " +
            format_fixed(evaluation.p95_error_m, 2) + " m\n";
    text += "mean normalised error squared: " + nees_text(evaluation.nees);
    text += "the same of the correct fixes: " + nees_text(evaluation.nees_correct);
    if (evaluation.centers) text += centers_text(*evaluation.centers, limit);
  }
  text += lean_text(evaluation.lean);
  if (timings && !std::isnan(evaluation.median_ms)) {
    text += "time of matching: median " + format_fixed(evaluation.median_ms, 1) + " ms, 95 % below " +
            format_fixed(evaluation.p95_ms, 1) + " ms\n";
  }
  return text;
}

}  // namespace pilotage
