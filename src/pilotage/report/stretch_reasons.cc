#include "pilotage/report/stretch_reasons.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "pilotage/base/text.h"
#include "pilotage/base/wording.h"
#include "pilotage/matchability/reason_words.h"
#include "pilotage/report/report.h"

namespace pilotage {
namespace {

constexpr const char* kLessDrift = "Fly with a better inertial grade or a velocity aid, or allow a larger error.";
constexpr const char* kMoreStructure = "Lead the route over ground with structure: roads, buildings, edges of fields.";
constexpr double kSurelyFound = 0.5;  // a convention: found more often than not

bool lies_between(const ReportTile& tile, double from_m, double to_m) {
  return tile.place.distance_m >= from_m && tile.place.distance_m <= to_m;
}

// The commonest reasons of the tiles that are not selected there, at most three, causes before what follows from them.
StretchReasons explain_refused(const Report& report, double from_m, double to_m) {
  std::vector<const TileScores*> refused;
  for (const ReportTile& tile : report.tiles) {
    if (!tile.selected && lies_between(tile, from_m, to_m)) refused.push_back(&tile.score);
  }
  if (refused.empty()) return {};
  const std::string tiles = std::to_string(refused.size());
  ReasonCounts order = count_reasons(refused);
  if (order.empty()) return {"Its " + tiles + " tiles show no single reason; click them on the map.", ""};
  order.resize(std::min<std::size_t>(order.size(), 3));
  std::vector<std::string> parts;
  for (const auto& [code, count] : order) {
    parts.push_back(std::string(reason_words(code).what) +
                    (parts.empty() ? " (" + std::to_string(count) + " of " + tiles + " tiles)"
                                   : " (" + std::to_string(count) + ")"));
  }
  return {capitalized(join(parts, ", ") + "."), std::string(reason_words(order.front().first).todo)};
}

// Whether GNSS is lost there: at the start, or where it is denied from, to a step of the plan's samples.
bool loses_gnss_at(const Report& report, double from_m) {
  constexpr double kStep_m = 10;
  if (report.denied.empty()) return from_m <= 0;
  return std::any_of(report.denied.begin(), report.denied.end(), [&](const DeniedStretch& stretch) {
    return std::abs(stretch.from_distance_m - from_m) <= kStep_m;
  });
}

// "From its start the inertial system alone stays within 50 m for 8 s = 119 m at 15 m/s." ; "" when it is not known.
std::string reach_text(const Report& report, double from_m) {
  const InertialReach& reach = report.inertial_reach;
  const bool at_start = loses_gnss_at(report, from_m);
  const double time_s = at_start ? reach.from_start_s : reach.after_fix_s;
  if (!std::isfinite(time_s)) return "";
  return std::string(at_start ? "From its start" : "After a fix") + " the inertial system alone stays within " +
         error_text(report.max_error_m) + " for " + duration_text(time_s) + " = " +
         length_text(time_s * reach.speed_mps) + " at " + format_fixed(reach.speed_mps, 1) + " m/s.";
}

// With what probability frames along the stretch give a fix, the least and the largest over chosen tiles; nothing where
// there is no such tile, or where it is not known.
std::optional<std::pair<double, double>> fix_range(const Report& report, double from_m, double to_m) {
  std::optional<std::pair<double, double>> range;
  for (const ErrorSample& sample : report.error_profile) {
    const double p = sample.p_correct_fix;
    if (sample.distance_m < from_m || sample.distance_m > to_m || !(p > 0)) continue;
    range = range ? std::pair(std::min(range->first, p), std::max(range->second, p)) : std::pair(p, p);
  }
  return range;
}

std::string fix_text(const std::optional<std::pair<double, double>>& range) {
  if (!range) return "";
  const std::string low = number_text(range->first, 2);
  const std::string high = number_text(range->second, 2);
  return "A frame over the chosen tiles there gives a fix with P " + low + (low == high ? "" : " to " + high) + ".";
}

std::string sentences(const std::vector<std::string>& texts) {
  std::vector<std::string> said;
  for (const std::string& text : texts) {
    if (!text.empty()) said.push_back(text);
  }
  return join(said, " ");
}

// Why flights are lost where tiles are chosen: how soon the inertial system drifts off, how surely a fix comes before,
// and what is wrong with the tiles that are not chosen.
StretchReasons explain_lost(const Report& report, double from_m, double to_m) {
  const StretchReasons refused = explain_refused(report, from_m, to_m);
  const auto range = fix_range(report, from_m, to_m);
  const std::string fix = fix_text(range);
  const std::string not_chosen = refused.why.empty() || fix.empty() ? refused.why : "Not chosen: " + refused.why;
  return {sentences({reach_text(report, from_m), fix, not_chosen}),
          sentences({kLessDrift, range && range->second < kSurelyFound ? kMoreStructure : refused.todo})};
}

}  // namespace

StretchReasons stretch_reasons(const Report& report, double from_m, double to_m, bool lost) {
  if (lost) {
    StretchReasons explanation = explain_lost(report, from_m, to_m);
    if (!explanation.why.empty()) return explanation;
  }
  StretchReasons explanation = explain_refused(report, from_m, to_m);
  if (!explanation.why.empty()) return explanation;
  const auto chosen = std::count_if(report.tiles.begin(), report.tiles.end(), [&](const ReportTile& tile) {
    return tile.selected && lies_between(tile, from_m, to_m);
  });
  if (chosen == 0) return {"No tile of the plan lies there.", "Let the plan cover it: imagery or heights are missing."};
  return {sentences({"All " + std::to_string(chosen) + " tiles there are chosen.",
                     fix_text(fix_range(report, from_m, to_m)), reach_text(report, from_m)}),
          kLessDrift};
}

std::string advice_text(const Report& report, const std::vector<LegAdvice>& advice, double from_m, double to_m) {
  std::string text;
  for (const LegAdvice& entry : advice) {
    const auto leg = std::find_if(report.legs.begin(), report.legs.end(),
                                  [&](const ReportLeg& candidate) { return candidate.status.leg == entry.leg; });
    if (leg == report.legs.end() || entry.p_after <= entry.p_before) continue;
    if (leg->from_distance_m > to_m || leg->from_distance_m + leg->status.length_m < from_m) continue;
    const std::string line = entry.side == AdviceSide::kNone
                                 ? " with every tile that can be matched"
                                 : " flown " + format_fixed(entry.offset_m, 0) + " m to the " +
                                       (entry.side == AdviceSide::kLeft ? "left" : "right");
    text += (text.empty() ? "" : " ") + std::string("Leg ") + std::to_string(entry.leg + 1) + line +
            " stays within the limit with P = " + probability_text(entry.p_after) + " instead of " +
            probability_text(entry.p_before) + ".";
  }
  return text;
}

std::string where_text(const Report& report, double from_m, double to_m, int leg) {
  int last = leg;
  for (const ReportLeg& entry : report.legs) {
    if (entry.from_distance_m < to_m - 1) last = std::max(last, entry.status.leg);
  }
  const std::string legs = last == leg ? "leg " + std::to_string(leg + 1)
                                       : "legs " + std::to_string(leg + 1) + " to " + std::to_string(last + 1);
  return length_text(from_m) + " – " + length_text(to_m) + ", " + legs;
}

}  // namespace pilotage
