#include "pilotage/verdict/quality.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "pilotage/base/text.h"
#include "pilotage/base/wording.h"
#include "pilotage/verdict/disagreement.h"
#include "pilotage/verdict/evidence.h"
#include "pilotage/verdict/imagery_age.h"
#include "pilotage/verdict/map_holds.h"

namespace pilotage {
namespace {

using Limits = QualityThresholds;

QualityRow largest_error_row(const Selection& selection) {
  QualityRow row;
  row.name = "largest_error";
  row.kind = NumberKind::kModelled;
  row.label = "Largest position error between fixes (" + format_number(selection.sigma_multiple) + "σ)";
  row.number = largest_error_m(selection);
  row.unit = "m";
  row.value = comparison_text(row.number, selection.max_error_m);
  row.threshold = "good up to " + error_text(Limits::kErrorShareGood * selection.max_error_m) +
                  " (80 % of the limit), marginal up to " + error_text(selection.max_error_m);
  row.status = judge_error(row.number, selection.max_error_m);
  if (!selection.within_limit) row.status = QualityStatus::kBad;
  row.decides = true;
  if (row.status == QualityStatus::kBad) {
    row.advice =
        "Lead the worst legs over ground that can be matched, widen the corridor or add imagery there, fly with a "
        "better "
        "inertial grade, or raise the limit if the mission allows it.";
  } else if (row.status == QualityStatus::kMarginal) {
    row.advice = "Little reserve: one missed fix may exceed the limit. Shorten the longest gap.";
  }
  return row;
}

QualityRow longest_gap_row(const Selection& selection) {
  QualityRow row;
  row.name = "longest_gap";
  row.kind = NumberKind::kModelled;
  row.label = "Longest stretch without a fix";
  row.unit = "m";
  row.threshold = "judged by the error at its end, as above";
  row.decides = true;
  const RouteGap* gap = longest_gap(selection);
  if (gap == nullptr) {
    row.number = 0;
    row.value = "none";
    return row;
  }
  row.number = gap->to_distance_m - gap->from_distance_m;
  row.value = gap_text(*gap) + ", leg " + std::to_string(gap->leg + 1);
  row.status = judge_error(gap->error_m, selection.max_error_m);
  if (!gap->within_limit) row.status = QualityStatus::kBad;
  if (row.status != QualityStatus::kGood) {
    row.advice = "Error at its end " + comparison_text(gap->error_m, selection.max_error_m) +
                 ". A waypoint beside it that crosses matchable ground splits it in two.";
  }
  return row;
}

QualityRow probability_row(const RouteProbability& route) {
  QualityRow row;
  row.name = "route_probability";
  row.kind = NumberKind::kModelled;
  row.label = "Probability that the error stays within its limit";
  row.number = route.p_within_limit;
  row.unit = "1";
  row.value = probability_comparison(route) + "; expected fixes " + number_text(route.expected_fixes, 1) +
              ", false ones at most " + number_text(route.expected_false_fixes, 4);
  row.threshold = "good from " + probability_text(route.min_p_within_limit) +
                  " at the lower end of its interval, bad below at its mean";
  row.status = judge_route(route);
  row.decides = true;
  if (row.status == QualityStatus::kGood) return row;
  if (row.status == QualityStatus::kMarginal) {
    row.advice = std::string(kIntervalBelow) +
                 ". A second date of this ground narrows it (score --second-epoch, calibrate --adapt); "
                 "another line may raise it (reroute).";
    return row;
  }
  row.advice =
      "Lead the route over ground with a larger probability of a correct fix (--advise looks for a line beside it).";
  if (route.worst) {
    row.advice += " Most flights are lost between " + length_text(route.worst->from_distance_m) + " and " +
                  length_text(route.worst->to_distance_m) + ", on leg " + std::to_string(route.worst->leg + 1) + ".";
  }
  return row;
}

// For a selection whose tiles nobody judged.
QualityRow not_judged_row() {
  QualityRow row;
  row.name = "matchability_judged";
  row.label = "Whether the matcher finds the tiles";
  row.unit = "1";
  row.number = 0;
  row.value = "not judged";
  row.threshold = "good with a probability of a correct fix or a margin of any selected tile";
  row.status = QualityStatus::kBad;
  row.decides = true;
  row.advice =
      "No selected tile has a probability of a correct fix or a margin: score with the measure `correct_fix`, or "
      "`degraded`.";
  return row;
}

QualityRow matchable_row(const Selection& selection) {
  QualityRow row;
  row.name = "matchable_length";
  row.label = "Route over selected tiles";
  row.number = selection.matchable_fraction;
  row.unit = "1";
  row.value = percent_text(row.number);
  row.threshold = "good from 50 %, marginal below; a sparse map is meant to be below";
  row.status = judge_at_least(row.number, Limits::kMatchableGood, 0);
  if (row.status != QualityStatus::kGood) {
    row.advice =
        "Few chances to try again when a fix is refused. Raise the size budget or select without sparse areas.";
  }
  return row;
}

QualityRow selected_row(const JudgedPlan& plan) {
  QualityRow row;
  row.name = "selected_tiles";
  row.label = "Tiles selected for the map";
  row.number = static_cast<double>(plan.selection.tile_ids.size());
  row.unit = "tiles";
  row.value =
      std::to_string(plan.selection.tile_ids.size()) + " of " + std::to_string(plan.mission.ground.tiles.size());
  if (plan.selection.estimated_bytes > 0) {
    row.value += ", about " + bytes_text(static_cast<double>(plan.selection.estimated_bytes));
  }
  row.threshold = "good from 1";
  row.decides = true;
  if (plan.selection.tile_ids.empty()) {
    row.status = QualityStatus::kMarginal;
    row.advice = "The map is empty: the flight would rest on the inertial system alone.";
  }
  return row;
}

QualityRow coverage_row(const Mission& mission) {
  QualityRow row;
  row.name = "imagery_coverage";
  row.kind = NumberKind::kMeasured;
  row.label = "Corridor covered by imagery";
  double sum = 0;
  double count = 0;
  const int finest = mission.ground.tiles.empty() ? 0 : mission.ground.tiles.front().level;
  for (const GroundTile& tile : mission.ground.tiles) {
    if (tile.level != finest) continue;
    sum += tile.valid_fraction;
    ++count;
  }
  row.number = count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
  row.unit = "1";
  row.value = percent_text(row.number);
  row.threshold = "good from 99 %, marginal from 90 %";
  row.status = judge_at_least(row.number, Limits::kCoverageGood, Limits::kCoverageMarginal);
  if (row.status != QualityStatus::kGood)
    row.advice = "Add imagery where the map shows hatching, or narrow the corridor.";
  return row;
}

QualityRow distortion_row(const Mission& mission) {
  QualityRow row;
  row.name = "scale_distortion";
  row.label = "Scale distortion of the mission grid";
  row.number = mission.ground.max_scale_distortion;
  row.unit = "1";
  row.value = number_text(mission.ground.max_scale_distortion * 100, 3) + " %";
  row.threshold = "good up to 0.1 %, marginal up to 0.5 %";
  row.status = judge_at_least(-row.number, -Limits::kDistortionGood, -Limits::kDistortionMarginal);
  row.decides = true;
  if (row.status != QualityStatus::kGood)
    row.advice = "Let the grid be chosen automatically (no --crs), or split the route.";
  return row;
}

QualityRow gsd_row(const Mission& mission) {
  QualityRow row;
  row.name = "map_gsd";
  row.label = "Ground sample distance of the map";
  row.unit = "m/px";
  std::vector<std::string> texts;
  for (const GridLevel& level : mission.ground.levels) {
    if (std::isnan(row.number) || level.gsd_m < row.number) row.number = level.gsd_m;
    texts.push_back(number_text(level.gsd_m, 2) + " m/px");
  }
  row.value = texts.empty() ? "unknown" : join(texts, ", ");
  row.threshold = "good from 0.5 to 1 m/px, marginal outside";
  if (row.number >= Limits::kGsdFinest_m && row.number <= Limits::kGsdCoarsest_m) return row;
  row.status = QualityStatus::kMarginal;
  row.advice = row.number < Limits::kGsdFinest_m
                   ? "Fine texture differs between dates and sensors: try --gsd-m 0.5; the map also becomes smaller."
                   : "Coarse for low flight: use finer imagery where there is any.";
  return row;
}

QualityRow footprint_row(const Mission& mission) {
  QualityRow row;
  row.name = "footprint_pixels";
  row.label = "Map pixels across a tile";
  row.unit = "px";
  for (const GridLevel& level : mission.ground.levels) {
    const double size_px = level.matrix.tile_size_px;
    if (std::isnan(row.number) || size_px < row.number) row.number = size_px;
  }
  row.value = std::isnan(row.number) ? "unknown" : number_text(row.number, 0) + " px";
  row.threshold = "good from 256 px, marginal from 128 px";
  row.status = judge_at_least(row.number, Limits::kFootprintPixelsGood, Limits::kFootprintPixelsMarginal);
  if (row.status != QualityStatus::kGood)
    row.advice = "Fly higher, use a wider lens, or a finer --gsd-m if the imagery allows it.";
  return row;
}

QualityRow scored_row(const JudgedPlan& plan) {
  std::size_t scored = 0;
  std::size_t little = 0;
  std::size_t flat = 0;
  for (const TileScores& score : plan.scores) {
    if (score.status == TileStatus::kScored) ++scored;
    if (score.status == TileStatus::kTooLittleGround) ++little;
    if (score.status == TileStatus::kFlat) ++flat;
  }
  const std::size_t all = plan.mission.ground.tiles.size();
  QualityRow row;
  row.name = "scored_tiles";
  row.kind = NumberKind::kMeasured;
  row.label = "Tiles that could be scored";
  row.number =
      all > 0 ? static_cast<double>(scored) / static_cast<double>(all) : std::numeric_limits<double>::quiet_NaN();
  row.unit = "1";
  row.value = percent_text(row.number) + " (" + std::to_string(scored) + " scored, " + std::to_string(little) +
              " with too little ground, " + std::to_string(flat) + " flat)";
  row.threshold = "good from 95 %, marginal from 80 %";
  row.status = judge_at_least(row.number, Limits::kScoredGood, Limits::kScoredMarginal);
  if (row.status != QualityStatus::kGood)
    row.advice = "See the hatched tiles on the map: imagery is missing or shows nothing.";
  return row;
}

QualityRow ambiguous_row(const JudgedPlan& plan) {
  const std::set<std::int64_t> selected(plan.selection.tile_ids.begin(), plan.selection.tile_ids.end());
  std::size_t judged = 0;
  std::size_t ambiguous = 0;
  for (std::size_t i = 0; i < plan.scores.size(); ++i) {
    const TileScores& score = plan.scores[i];
    if (!selected.contains(plan.mission.ground.tiles[i].tile_id) || std::isnan(score.degraded.margin)) continue;
    ++judged;
    if (score.degraded.margin <= 0) ++ambiguous;
  }
  QualityRow row;
  row.name = "ambiguous_tiles";
  row.kind = NumberKind::kSimulated;
  row.label = "Selected tiles with a rival as good as themselves";
  row.unit = "tiles";
  row.threshold = "good at 0 (margin on degraded copies above 0), marginal above";
  if (judged == 0) {
    row.value = "not judged";
    row.status = QualityStatus::kMarginal;
    row.advice = "No selected tile has a margin on degraded copies: score with the measure `degraded`.";
    return row;
  }
  row.number = static_cast<double>(ambiguous);
  row.value = std::to_string(ambiguous) + " of " + std::to_string(judged);
  if (ambiguous > 0) {
    row.status = QualityStatus::kMarginal;
    row.advice = "Repeated patterns (orchards, roofs, parking rows): expect refused or false fixes there.";
  }
  return row;
}

QualityRow imagery_date_row(const Mission& mission) {
  QualityRow row;
  row.name = "imagery_dates";
  row.label = "Imagery with a known date";
  row.unit = "files";
  std::vector<std::string> dates;
  for (const ImageryDataset& imagery : mission.ground.imagery.datasets) {
    if (!imagery.acquired.empty()) dates.push_back(imagery.acquired);
  }
  row.number = static_cast<double>(dates.size());
  row.value = std::to_string(dates.size()) + " of " + std::to_string(mission.ground.imagery.datasets.size());
  std::sort(dates.begin(), dates.end());
  if (!dates.empty()) row.value += ", " + dates.front();
  if (!dates.empty() && dates.back() != dates.front()) row.value += " to " + dates.back();
  row.threshold = "good when every file tells its date";
  if (dates.size() < mission.ground.imagery.datasets.size() || mission.ground.imagery.datasets.empty()) {
    row.status = QualityStatus::kMarginal;
    row.advice = "Check by hand how old the imagery is: vegetation, building sites and water change first.";
  }
  return row;
}

}  // namespace

std::string_view status_name(QualityStatus status) {
  if (status == QualityStatus::kGood) return "good";
  return status == QualityStatus::kMarginal ? "marginal" : "bad";
}

std::string_view verdict_name(QualityStatus status) {
  if (status == QualityStatus::kGood) return "GO";
  return status == QualityStatus::kMarginal ? "MARGINAL" : "NO-GO";
}

QualityStatus judge_at_least(double number, double good, double marginal) {
  if (number >= good) return QualityStatus::kGood;
  return number >= marginal ? QualityStatus::kMarginal : QualityStatus::kBad;
}

QualityStatus judge_error(double error_m, double limit_m) {
  if (error_m <= QualityThresholds::kErrorShareGood * limit_m) return QualityStatus::kGood;
  return error_m <= limit_m ? QualityStatus::kMarginal : QualityStatus::kBad;
}

QualityStatus judge_route(const RouteProbability& route) {
  if (!(route.p_within_limit >= route.min_p_within_limit)) return QualityStatus::kBad;
  const bool known = !route.interval || route.interval->low >= route.min_p_within_limit;
  return known ? QualityStatus::kGood : QualityStatus::kMarginal;
}

bool too_often_lost(const Selection& selection) {
  return selection.probability && selection.probability->p_within_limit < selection.probability->min_p_within_limit;
}

QualityStatus judge_probability(double p_within_limit, const Selection& selection) {
  if (!selection.probability) return QualityStatus::kGood;
  const double asked = selection.probability->min_p_within_limit;
  return judge_at_least(p_within_limit, (1 + asked) / 2, asked);
}

QualityStatus judge_leg(const LegStatus& leg, const Selection& selection) {
  if (!leg.within_limit) return QualityStatus::kBad;
  return std::max(judge_error(leg.max_error_m, selection.max_error_m),
                  judge_probability(leg.p_within_limit, selection));
}

QualityStatus judge_gap(const RouteGap& gap, const Selection& selection) {
  if (!gap.within_limit) return QualityStatus::kBad;
  QualityStatus status = judge_error(gap.error_m, selection.max_error_m);
  if (!selection.probability) return status;
  if (!std::isnan(gap.p_first_excess)) {
    status = std::max(status, judge_probability(1 - gap.p_first_excess, selection));
  }
  const auto& worst = selection.probability->worst;
  const bool in_worst =
      worst && gap.from_distance_m < worst->to_distance_m && gap.to_distance_m > worst->from_distance_m;
  return too_often_lost(selection) && in_worst ? QualityStatus::kBad : status;
}

double largest_error_m(const Selection& selection) {
  std::vector<double> errors;
  for (const ErrorSample& sample : selection.error_profile) errors.push_back(sample.error_m);
  for (const RouteGap& gap : selection.gaps) errors.push_back(gap.error_m);
  for (const LegStatus& leg : selection.legs) errors.push_back(leg.max_error_m);
  const bool unknown = std::any_of(errors.begin(), errors.end(), [](double error_m) { return std::isnan(error_m); });
  if (errors.empty() || unknown) return std::numeric_limits<double>::quiet_NaN();
  return *std::max_element(errors.begin(), errors.end());
}

const RouteGap* longest_gap(const Selection& selection) {
  const RouteGap* longest = nullptr;
  for (const RouteGap& gap : selection.gaps) {
    const double length_m = gap.to_distance_m - gap.from_distance_m;
    if (longest == nullptr || length_m > longest->to_distance_m - longest->from_distance_m) longest = &gap;
  }
  return longest;
}

std::string gap_text(const RouteGap& gap) {
  const double length_m = gap.to_distance_m - gap.from_distance_m;
  std::string text = length_text(length_m);
  if (!(gap.duration_s > 0) || !std::isfinite(gap.duration_s)) return text;
  const double speed_mps = length_m / gap.duration_s;
  text += " = " + duration_text(gap.duration_s);
  return text + " at " + format_fixed(speed_mps, speed_mps < 9.95 ? 1 : 0) + " m/s";
}

std::string probability_comparison(const RouteProbability& route) {
  std::string text = probability_text(route.p_within_limit) +
                     (route.p_within_limit >= route.min_p_within_limit ? " ≥ " : " < ") +
                     probability_text(route.min_p_within_limit);
  if (!route.interval) return text;
  return text + ", 80 % interval " + probability_text(route.interval->low) + " … " +
         probability_text(route.interval->high);
}

std::vector<QualityRow> quality_rows(const JudgedPlan& plan) {
  std::vector<QualityRow> rows = {largest_error_row(plan.selection),
                                  longest_gap_row(plan.selection),
                                  matchable_row(plan.selection),
                                  selected_row(plan),
                                  ambiguous_row(plan),
                                  coverage_row(plan.mission),
                                  scored_row(plan),
                                  gsd_row(plan.mission),
                                  footprint_row(plan.mission),
                                  distortion_row(plan.mission),
                                  imagery_date_row(plan.mission)};
  for (QualityRow& row : imagery_age_rows(plan.mission)) rows.push_back(std::move(row));
  if (auto row = ageing_row(plan.mission, plan.selection)) rows.push_back(*std::move(row));
  if (const auto found = georeference_disagreement(plan)) {
    rows.insert(rows.begin() + 2, disagreement_row(*found, plan.selection));
  }
  if (const auto& probability = plan.selection.probability) {
    rows.insert(rows.begin() + 2, probability_row(*probability));
  }
  for (const Simulation& simulation : plan.simulations) {
    rows.insert(rows.begin() + 2, simulated_row(simulation, plan.selection));
  }
  if (plan.flown != nullptr) rows.insert(rows.begin() + 2, flown_row(*plan.flown, plan.selection));
  if (!plan.selection.matchability_judged) rows.insert(rows.begin() + 2, not_judged_row());
  return rows;
}

}  // namespace pilotage
