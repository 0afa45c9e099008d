#include "pilotage/verdict/verdict.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "pilotage/base/options.h"
#include "pilotage/base/text.h"
#include "pilotage/base/wording.h"
#include "pilotage/ins/ins_products.h"
#include "pilotage/verdict/evidence.h"
#include "pilotage/verdict/imagery_age.h"

namespace pilotage {
namespace {

// "95 of 100 flights stay", "fewer than 1 of 100 flights stay", "1 of 100 flights stays"
std::string flights_text(double p) {
  const double of_hundred = std::floor(p * 100 + 1e-9);
  if (!(of_hundred >= 1)) return "fewer than 1 of 100 flights stay";
  return format_fixed(of_hundred, 0) + " of 100 flights " + (of_hundred == 1 ? "stays" : "stay");
}

std::string modelled_headline(const Selection& selection) {
  if (!selection.probability) {
    return "the error is predicted up to " + comparison_text(largest_error_m(selection), selection.max_error_m) +
           ", if what is assumed holds and every fix comes; how often fixes come is not known";
  }
  const RouteProbability& route = *selection.probability;
  return flights_text(route.p_within_limit) + " within " + error_text(selection.max_error_m) + " all the way, " +
         (too_often_lost(selection) ? "even " : "") + "if what is assumed holds (P = " + probability_comparison(route) +
         ")";
}

constexpr std::size_t kMostStretchesNamed = 3;

// What the inertial system has learned of fixes before a loss counts; a navigator that looks at the ground only when
// GNSS is gone knows less.
constexpr const char* kFixesWithGnss = ", fixes taken where it is had, too";

}  // namespace

QualityStatus verdict_of(const std::vector<QualityRow>& rows) {
  QualityStatus verdict = QualityStatus::kGood;
  bool decided = false;
  for (const QualityRow& row : rows) {
    if (!row.decides) continue;
    decided = true;
    verdict = std::max(verdict, row.status);
  }
  return decided ? verdict : QualityStatus::kBad;
}

std::string headline(const std::vector<QualityRow>& rows, const Selection& selection) {
  if (const QualityRow* against = contradiction(rows)) {
    return "the plan is contradicted: " + against->label + ": " + against->value + "; by the model alone " +
           modelled_headline(selection);
  }
  return modelled_headline(selection);
}

std::string verdict_detail(QualityStatus verdict, const std::vector<QualityRow>& rows, const Selection& selection) {
  std::string text;
  const bool lost = too_often_lost(selection);
  if (lost && selection.probability->worst) {
    const WorstStretch& worst = *selection.probability->worst;
    text = "most are lost from " + length_text(worst.from_distance_m) + " to " + length_text(worst.to_distance_m) +
           " (leg " + std::to_string(worst.leg + 1) + "), where fixes fail too often; ";
  }
  text += "matchable on " + percent_text(selection.matchable_fraction) + " of its length";
  const RouteGap* gap = longest_gap(selection);
  const double error_m = largest_error_m(selection);
  // The errors along the route are those of a flight whose every try over a chosen tile gives a fix.
  const std::string where = lost ? "if every fix came, " : "";
  if (gap != nullptr) {
    text += "; longest gap " + gap_text(*gap) + "; " + where + "drift there " +
            comparison_text(gap->error_m, selection.max_error_m);
  } else {
    text += "; no gap";
  }
  const bool said = gap != nullptr && error_text(gap->error_m) == error_text(error_m);
  if (!said) text += "; " + where + "largest error " + comparison_text(error_m, selection.max_error_m);
  const QualityRow* against = contradiction(rows);
  for (const QualityRow& row : rows) {
    if (!row.decides || row.status != verdict || verdict == QualityStatus::kGood || &row == against) continue;
    if (row.name == "largest_error" || row.name == "longest_gap") continue;
    if (row.name == "route_probability") {
      if (verdict == QualityStatus::kMarginal) text += std::string("; ") + kIntervalBelow;
      continue;
    }
    text += "; " + row.label + ": " + row.value;
  }
  return text;
}

std::string verdict_sentence(QualityStatus verdict, const std::vector<QualityRow>& rows, const Selection& selection) {
  return std::string(verdict_name(verdict)) + ": " + (selection.probability ? headline(rows, selection) + "; " : "") +
         verdict_detail(verdict, rows, selection);
}

std::string gnss_text(const Flight& flight, const Selection& selection) {
  if (selection.loss_anywhere) {
    const LossPoint& worst = selection.loss_anywhere->points[selection.loss_anywhere->worst];
    return "GNSS lost for good at the worst point, " + length_text(worst.distance_m) + " (leg " +
           std::to_string(worst.leg + 1) + ")" + (worst.distance_m > 0 ? kFixesWithGnss : "");
  }
  const std::vector<DeniedStretch>& stretches = flight.denied.stretches;
  if (stretches.empty()) return "GNSS lost at the first point";
  std::vector<std::string> named;
  double total_m = 0;
  for (const DeniedStretch& stretch : stretches) {
    named.push_back("from " + length_text(stretch.from_distance_m) + " to " + length_text(stretch.to_distance_m));
    total_m += stretch.to_distance_m - stretch.from_distance_m;
  }
  const std::string where = stretches.size() <= kMostStretchesNamed
                                ? join(named, " and ")
                                : "over " + std::to_string(stretches.size()) + " stretches, " + length_text(total_m) +
                                      " in all, the first " + named.front();
  const bool comes_back = !flight.samples.empty() && stretches.front().to_distance_m < flight.samples.back().distance_m;
  const bool had = comes_back || stretches.back().from_distance_m > 0;
  return "GNSS denied " + where + (comes_back ? ", trusted at once where it comes back" : "") +
         (had ? kFixesWithGnss : "");
}

std::string map_error_text(const Mission& mission) {
  const auto& datasets = mission.ground.imagery.datasets;
  const bool by_imagery = std::any_of(datasets.begin(), datasets.end(),
                                      [](const ImageryDataset& image) { return !image.map_sigma.empty(); });
  const double sigma_m = mission.flight.conditions.map_sigma_m.value_or(kUnknownMapSigma_m);
  return "map error " + (by_imagery ? format_fixed(sigma_m, 2) : format_number(sigma_m)) + " m on each axis" +
         (by_imagery ? " (the largest over the tiles: what imagery says of itself, modelled, else 1 m)" : "");
}

std::string further_assumptions(const Mission& mission, const Selection& selection) {
  const std::string rests_on = selection.probability ? rests_on_text(*selection.probability) : "";
  std::optional<bool> counts_age;
  if (selection.probability) {
    counts_age = selection.ageing || std::isfinite(selection.probability->level_age_months);
  }
  const FlightConditions& conditions = mission.flight.conditions;
  const std::string met = selection.probability ? ", wind " + format_number(conditions.wind_sigma_mps) + " m/s and " +
                                                      map_error_text(mission)
                                                : ", " + map_error_text(mission);
  return met + (mission.flight.flat_ground_amsl_m ? ", flat ground at home's height (default)" : "") +
         (mission.ground.elevation_datum_assumed ? ", heights of the ground " + mission.ground.elevation_datum : "") +
         imagery_age_assumptions(mission, counts_age) + (rests_on.empty() ? "" : "; " + rests_on);
}

bool limit_is_default(const Flight& flight, const Selection& selection) {
  return flight.max_error_assumed && selection.max_error_m == flight.max_error_m;
}

std::string assumptions_line(const Mission& mission, const Selection& selection) {
  const Flight& flight = mission.flight;
  return "assumes: " + ins_text(flight.ins) + ", " + gnss_text(flight, selection) + ", limit " +
         error_text(selection.max_error_m) + (limit_is_default(flight, selection) ? " (default)" : "") +
         further_assumptions(mission, selection);
}

}  // namespace pilotage
