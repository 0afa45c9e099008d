#include "pilotage/report/weak_places.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>

#include "pilotage/base/text.h"
#include "pilotage/report/reason_words.h"
#include "pilotage/report/report.h"
#include "pilotage/report/wording.h"

namespace pilotage {
namespace {

constexpr const char* kLessDrift = "Fly with a better inertial grade or a velocity aid, or allow a larger error.";
constexpr const char* kMoreStructure = "Lead the route over ground with structure: roads, buildings, edges of fields.";
constexpr double kSurelyFound = 0.5;  // a convention: found more often than not

struct Explanation {
  std::string why;
  std::string todo;
};

bool lies_between(const ReportTile& tile, double from_m, double to_m) {
  return tile.place.distance_m >= from_m && tile.place.distance_m <= to_m;
}

// The commonest reasons of the tiles that are not selected there, at most three, causes before what follows from them.
Explanation explain_refused(const Report& report, double from_m, double to_m) {
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
  std::string why = join(parts, ", ") + ".";
  why[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(why[0])));
  return {why, std::string(reason_words(order.front().first).todo)};
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
Explanation explain_lost(const Report& report, double from_m, double to_m) {
  const Explanation refused = explain_refused(report, from_m, to_m);
  const auto range = fix_range(report, from_m, to_m);
  const std::string fix = fix_text(range);
  const std::string not_chosen = refused.why.empty() || fix.empty() ? refused.why : "Not chosen: " + refused.why;
  return {sentences({reach_text(report, from_m), fix, not_chosen}),
          sentences({kLessDrift, range && range->second < kSurelyFound ? kMoreStructure : refused.todo})};
}

Explanation explain(const Report& report, double from_m, double to_m, bool lost) {
  if (lost) {
    Explanation explanation = explain_lost(report, from_m, to_m);
    if (!explanation.why.empty()) return explanation;
  }
  Explanation explanation = explain_refused(report, from_m, to_m);
  if (!explanation.why.empty()) return explanation;
  const auto chosen = std::count_if(report.tiles.begin(), report.tiles.end(), [&](const ReportTile& tile) {
    return tile.selected && lies_between(tile, from_m, to_m);
  });
  if (chosen == 0) return {"No tile of the plan lies there.", "Let the plan cover it: imagery or heights are missing."};
  return {sentences({"All " + std::to_string(chosen) + " tiles there are chosen.",
                     fix_text(fix_range(report, from_m, to_m)), reach_text(report, from_m)}),
          kLessDrift};
}

// "Leg 5 flown 80 m to the left stays within the limit with P = 0.971 instead of 0.812." of the legs in the place.
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

// "1.5 km – 2.2 km, legs 5 to 6"; `leg` is where it starts.
std::string where_text(const Report& report, double from_m, double to_m, int leg) {
  int last = leg;
  for (const ReportLeg& entry : report.legs) {
    if (entry.from_distance_m < to_m - 1) last = std::max(last, entry.status.leg);
  }
  const std::string legs = last == leg ? "leg " + std::to_string(leg + 1)
                                       : "legs " + std::to_string(leg + 1) + " to " + std::to_string(last + 1);
  return length_text(from_m) + " – " + length_text(to_m) + ", " + legs;
}

// A place and what it is ranked by.
struct Ranked {
  WeakPlace place;
  double p_lost = 0;
  double error_m = 0;
  bool lost = false;  // by probability, not by the error where every fix comes
};

Ranked gap_place(const Report& report, const ReportGap& entry) {
  const RouteGap& gap = entry.gap;
  Ranked ranked;
  ranked.place.from_distance_m = gap.from_distance_m;
  ranked.place.to_distance_m = gap.to_distance_m;
  ranked.place.status = entry.quality;
  ranked.lost = gap.within_limit && judge_error(gap.error_m, report.max_error_m) != entry.quality;
  ranked.place.where = where_text(report, gap.from_distance_m, gap.to_distance_m, gap.leg);
  ranked.place.what = length_text(entry.length_m) + " = " + duration_text(gap.duration_s) +
                      " without a fix; error at its end " + comparison_text(gap.error_m, report.max_error_m) +
                      (ranked.lost ? " if the fix before it came." : ".");
  ranked.p_lost = std::isnan(gap.p_first_excess) ? 0 : gap.p_first_excess;
  ranked.error_m = gap.error_m;
  return ranked;
}

// What no gap shows: a stretch with tiles, but tiles that are too often not found.
void add_worst_stretch(const Report& report, std::vector<Ranked>& places) {
  if (!report.probability || !report.probability->worst) return;
  if (report.probability->p_within_limit >= report.probability->min_p_within_limit) return;
  const WorstStretch& worst = *report.probability->worst;
  Ranked ranked;
  ranked.place.from_distance_m = worst.from_distance_m;
  ranked.place.to_distance_m = worst.to_distance_m;
  ranked.place.status = QualityStatus::kBad;
  ranked.place.where = where_text(report, worst.from_distance_m, worst.to_distance_m, worst.leg);
  ranked.place.what = "Most flights are lost here: with P = " + probability_text(worst.p_first_excess) +
                      " the error first exceeds its limit on this stretch.";
  ranked.p_lost = worst.p_first_excess;
  ranked.error_m = report.max_error_m;
  ranked.lost = true;
  // A gap that is bad only for lying here is this place.
  std::erase_if(places, [&](const Ranked& gap) {
    return gap.lost && gap.place.from_distance_m < worst.to_distance_m &&
           gap.place.to_distance_m > worst.from_distance_m;
  });
  places.push_back(ranked);
}

void add_legs(const Report& report, std::vector<Ranked>& places) {
  const std::size_t gaps = places.size();
  for (const ReportLeg& leg : report.legs) {
    if (leg.quality == QualityStatus::kGood || !std::isfinite(leg.from_distance_m)) continue;
    const double p = leg.status.p_within_limit;
    if (std::isnan(p) && report.probability && leg.status.within_limit) continue;  // flights are lost before it
    const double to_m = leg.from_distance_m + leg.status.length_m;
    const bool explained =
        std::any_of(places.begin(), places.begin() + static_cast<std::ptrdiff_t>(gaps), [&](const Ranked& gap) {
          return gap.place.status != QualityStatus::kGood && gap.place.from_distance_m <= to_m &&
                 gap.place.to_distance_m >= leg.from_distance_m;
        });
    if (explained) continue;
    Ranked ranked;
    ranked.place.from_distance_m = leg.from_distance_m;
    ranked.place.to_distance_m = to_m;
    ranked.place.status = leg.quality;
    ranked.place.where = where_text(report, leg.from_distance_m, to_m, leg.status.leg);
    ranked.lost = leg.status.within_limit && judge_error(leg.status.max_error_m, report.max_error_m) != leg.quality;
    ranked.place.what = "Largest error " + comparison_text(leg.status.max_error_m, report.max_error_m) +
                        (ranked.lost ? " if every fix came; of the flights that reach it within the limit a share of " +
                                           probability_text(p) + " stays within."
                                     : ".");
    ranked.p_lost = ranked.lost ? 1 - p : 0;
    ranked.error_m = leg.status.max_error_m;
    places.push_back(ranked);
  }
}

}  // namespace

std::vector<WeakPlace> weak_places(const Report& report, const std::vector<LegAdvice>& advice, std::size_t most) {
  std::vector<Ranked> ranked;
  for (const ReportGap& gap : report.gaps) ranked.push_back(gap_place(report, gap));
  add_worst_stretch(report, ranked);
  add_legs(report, ranked);
  const auto key = [](const Ranked& entry) {
    return std::tuple(static_cast<int>(entry.place.status), entry.p_lost,
                      std::isnan(entry.error_m) ? std::numeric_limits<double>::infinity() : entry.error_m);
  };
  std::stable_sort(ranked.begin(), ranked.end(), [&](const Ranked& a, const Ranked& b) { return key(a) > key(b); });
  ranked.resize(std::min(ranked.size(), most));
  std::vector<WeakPlace> places;
  for (Ranked& entry : ranked) {
    WeakPlace& place = entry.place;
    const Explanation explanation = explain(report, place.from_distance_m, place.to_distance_m, entry.lost);
    place.why = explanation.why;
    place.todo = advice_text(report, advice, place.from_distance_m, place.to_distance_m);
    if (place.todo.empty()) place.todo = explanation.todo;
    places.push_back(place);
  }
  return places;
}

}  // namespace pilotage
