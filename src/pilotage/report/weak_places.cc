#include "pilotage/report/weak_places.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "pilotage/base/wording.h"
#include "pilotage/report/report.h"
#include "pilotage/report/stretch_reasons.h"

namespace pilotage {
namespace {

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
  const WorstStretch* found = most_lost(report);
  if (found == nullptr) return;
  const WorstStretch& worst = *found;
  Ranked ranked;
  ranked.place.most_lost = true;
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

const WorstStretch* most_lost(const Report& report) {
  if (!report.probability || !report.probability->worst) return nullptr;
  const bool enough = report.probability->p_within_limit >= report.probability->min_p_within_limit;
  return enough ? nullptr : &*report.probability->worst;
}

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
    const StretchReasons reasons = stretch_reasons(report, place.from_distance_m, place.to_distance_m, entry.lost);
    place.why = reasons.why;
    place.todo = advice_text(report, advice, place.from_distance_m, place.to_distance_m);
    if (place.todo.empty()) place.todo = reasons.todo;
    places.push_back(place);
  }
  return places;
}

}  // namespace pilotage
