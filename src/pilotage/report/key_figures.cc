#include "pilotage/report/key_figures.h"

#include <algorithm>
#include <cmath>

#include "pilotage/base/statistics.h"
#include "pilotage/base/text.h"
#include "pilotage/base/wording.h"
#include "pilotage/mission/selection.h"
#include "pilotage/report/report.h"

namespace pilotage {
namespace {

void add_probability(const Report& report, std::vector<KeyFigure>& figures) {
  if (!report.probability) return;
  const RouteProbability& route = *report.probability;
  std::string detail = "asked for: " + probability_text(route.min_p_within_limit);
  if (route.interval) {
    detail = "80 % interval " + probability_text(route.interval->low) + " … " + probability_text(route.interval->high) +
             "; " + detail;
  }
  figures.push_back({"P within " + error_text(report.max_error_m), probability_text(route.p_within_limit), detail,
                     NumberKind::kModelled});
}

void add_simulations(const Report& report, std::vector<KeyFigure>& figures) {
  for (const Simulation& simulation : report.simulations) {
    const Share& within = simulation.within;
    if (within.of == 0) continue;
    const Interval interval = within.interval();
    figures.push_back({simulation.by_frames() ? "Flights by rendered frames" : "Simulated flights within it",
                       probability_text(within.value()),
                       std::to_string(within.count) + " of " + std::to_string(within.of) + ", 95 % interval " +
                           probability_text(interval.low) + " … " + probability_text(interval.high),
                       NumberKind::kSimulated});
  }
  if (report.simulations.empty()) figures.push_back({"Simulated flights", "none", "see simulate", NumberKind::kStated});
}

void add_flown(const Report& report, std::vector<KeyFigure>& figures) {
  if (!report.replay || !report.replay->flown || report.replay->flown->tries == 0) return;
  const FlownAgainstPlan& flown = *report.replay->flown;
  figures.push_back({"Fixes on flown flights", probability_text(Share{flown.fixes, flown.tries}.value()),
                     std::to_string(flown.fixes) + " of " + std::to_string(flown.tries) + " tries; predicted " +
                         probability_text(flown.predicted),
                     NumberKind::kMeasured});
}

void add_gap(const Report& report, std::vector<KeyFigure>& figures) {
  const auto longest = std::max_element(report.gaps.begin(), report.gaps.end(),
                                        [](const ReportGap& a, const ReportGap& b) { return a.length_m < b.length_m; });
  if (longest == report.gaps.end()) {
    figures.push_back({"Longest gap", "none", "", NumberKind::kModelled});
    return;
  }
  figures.push_back({"Longest gap", length_text(longest->length_m),
                     duration_text(longest->gap.duration_s) + "; drift there " + error_text(longest->gap.error_m),
                     NumberKind::kModelled});
}

}  // namespace

std::vector<KeyFigure> key_figures(const Report& report) {
  std::vector<KeyFigure> figures;
  add_probability(report, figures);
  add_simulations(report, figures);
  add_flown(report, figures);
  add_gap(report, figures);
  if (std::isfinite(report.largest_error_m)) {
    figures.push_back({"Largest error", error_text(report.largest_error_m),
                       "limit " + error_text(report.max_error_m) + "; " + format_number(report.sigma_multiple) +
                           " σ, if every fix comes",
                       NumberKind::kModelled});
  }
  figures.push_back({"Matchable", percent_text(report.matchable_fraction), "of " + length_text(report.route_length_m),
                     NumberKind::kModelled});
  if (report.estimated_bytes > 0) {
    figures.push_back({"Onboard map", bytes_text(static_cast<double>(report.estimated_bytes)),
                       "about; " + std::to_string(report.selected_tiles) + " tiles", NumberKind::kModelled});
  }
  return figures;
}

}  // namespace pilotage
