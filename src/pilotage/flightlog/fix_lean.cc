#include "pilotage/flightlog/fix_lean.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <nlohmann/json.hpp>

#include "pilotage/base/angle.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/statistics.h"
#include "pilotage/base/text.h"
#include "pilotage/match/refined_fix.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kLeanConfidence = 0.999;
constexpr double kToldSigmas = 2;

/// The largest k for which fewer than k heads of `tosses` are rarer than (1 − kLeanConfidence) / 2; 0: none is so rare.
std::size_t rare_heads(std::size_t tosses) {
  const auto n = static_cast<double>(tosses);
  double log_ways = 0;
  double chance = 0;
  for (std::size_t k = 0; k < tosses; ++k) {
    chance += std::exp(log_ways - n * std::log(2.0));
    if (chance > (1 - kLeanConfidence) / 2) return k;
    log_ways += std::log((n - static_cast<double>(k)) / (static_cast<double>(k) + 1));
  }
  return 0;
}

/// The place that was found, and whether it became the fix or was refused for its height.
const std::optional<Fix>& place_of(const FrameMatch& match, const MatchOptions& options) {
  const std::optional<Fix>& candidate = match.result.candidate;
  const bool by_height =
      match.result.status == MatchStatus::kOutsideGate && candidate && contradicts_told_height(*candidate, options);
  return by_height ? candidate : match.result.fix;
}

std::string way_text(const FixLean& lean) {
  const double east_m = lean.east_m.median;
  const double north_m = lean.north_m.median;
  return format_fixed(std::hypot(east_m, north_m), 1) + " m to the " +
         compass_name(std::atan2(east_m, north_m) / kRadPerDeg);
}

std::string percent_text(double share) {
  return format_fixed(std::abs(100 * share), 1) + " %";
}

std::string height_text(const FixLean& lean) {
  return percent_text(lean.height_share.median) + " (" + format_fixed(std::abs(lean.height_m.median), 1) + " m) " +
         (lean.height_share.median < 0 ? "below" : "above");
}

/// Of the interval, the value nearest to 0.
double least_of(const Lean& lean) {
  return std::clamp(0.0, lean.low, lean.high);
}

Json lean_json(const Lean& lean) {
  return {{"median", json_number(lean.median)}, {"low", json_number(lean.low)}, {"high", json_number(lean.high)}};
}

}  // namespace

Lean lean_of(std::vector<double> values) {
  if (values.empty()) return {};
  Lean lean;
  lean.median = quantile(values, 0.5);
  const std::size_t rare = rare_heads(values.size());
  if (rare == 0) return lean;
  std::sort(values.begin(), values.end());
  lean.low = values[rare - 1];
  lean.high = values[values.size() - rare];
  return lean;
}

FixLean lean_of_fixes(std::span<const FrameMatch> matches, const MatchOptions& options) {
  FixLean lean;
  std::vector<double> shares;
  std::vector<double> heights_m;
  std::vector<double> east_m;
  std::vector<double> north_m;
  std::vector<double> map_sigmas_m;
  std::vector<double> by_attitude_m;
  for (const FrameMatch& match : matches) {
    if (!match.readable()) continue;
    const std::optional<Fix>& place = place_of(match, options);
    if (!place) continue;
    shares.push_back(place->scale - 1);
    heights_m.push_back(place->height_agl_m - match.frame.height_agl_m);
    if (!match.has_fix() || !match.error) continue;
    east_m.push_back(match.error->east_m);
    north_m.push_back(match.error->north_m);
    map_sigmas_m.push_back(place->map_sigma_m);
    const double lever_m = match.frame.true_nadir ? place->height_agl_m : 0;
    by_attitude_m.push_back(lever_m * std::tan(options.attitude_sigma_deg * kRadPerDeg));
  }
  lean.heights = static_cast<std::int64_t>(shares.size());
  lean.judged = static_cast<std::int64_t>(east_m.size());
  lean.height_share = lean_of(std::move(shares));
  lean.height_m = lean_of(std::move(heights_m));
  lean.east_m = lean_of(std::move(east_m));
  lean.north_m = lean_of(std::move(north_m));
  if (lean.judged > 0) {
    lean.common_sigma_m = std::hypot(quantile(std::move(map_sigmas_m), 0.5), quantile(std::move(by_attitude_m), 0.5));
  }
  return lean;
}

std::vector<std::string> lean_warnings(const FixLean& lean, const MatchOptions& options) {
  std::vector<std::string> warnings;
  if (std::abs(lean.height_share.median) > kToldSigmas * options.height_sigma_fraction &&
      std::abs(least_of(lean.height_share)) > options.height_sigma_fraction) {
    warnings.push_back("the places that are found lie " + height_text(lean) +
                       " the heights that the matcher was told, in the median of " + std::to_string(lean.heights) +
                       ", where it was told that they are good to " + percent_text(options.height_sigma_fraction) +
                       ": heights of another datum, an altimeter or a focal length that is off; where they are off by "
                       "more, frames are refused");
  }
  const double least_m = std::hypot(least_of(lean.east_m), least_of(lean.north_m));
  if (lean.judged > 0 && least_m > std::sqrt(chi_squared_quantile(kLeanConfidence, 2)) * lean.common_sigma_m) {
    warnings.push_back("the fixes lean " + way_text(lean) + ", in the median of " + std::to_string(lean.judged) +
                       ", more than the " + format_fixed(lean.common_sigma_m, 1) +
                       " m explain by which map and attitude may shift them all: imagery that lies elsewhere (another "
                       "datum, a shift), a camera's mount that is off, or a truth that is");
  }
  return warnings;
}

Json to_json(const FixLean& lean) {
  if (lean.heights == 0) return nullptr;
  Json json{{"heights", lean.heights},
            {"height_share", lean_json(lean.height_share)},
            {"height_m", lean_json(lean.height_m)},
            {"judged", lean.judged}};
  if (lean.judged > 0) {
    json["east_m"] = lean_json(lean.east_m);
    json["north_m"] = lean_json(lean.north_m);
    json["common_sigma_m"] = lean.common_sigma_m;
  }
  return json;
}

std::string lean_text(const FixLean& lean) {
  if (lean.heights == 0) return "";
  std::string text = "all together: heights " + height_text(lean) + " what was told";
  if (lean.judged > 0) text += ", places " + way_text(lean);
  return text + " (medians)\n";
}

}  // namespace pilotage
