#include "pilotage/replay/replay.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "pilotage/base/nan.h"
#include "pilotage/base/statistics.h"
#include "pilotage/geo/geodesic.h"

namespace pilotage {
namespace {

/// A frame with the ground below it.
struct Try {
  const ReplayedFrame* frame = nullptr;
  std::optional<PredictedTile> tile;
  std::optional<LinePlace> line;
  bool line_is_stored = false;
  bool too_unsure = false;
  std::int64_t block = 0;
};

std::vector<Try> tries_of(const ReplayedFlight& flight, std::size_t number, PredictedTiles& tiles,
                          const std::optional<FlownPlan>& plan, const ReplayScoring& scoring) {
  std::vector<std::optional<LinePlace>> line(flight.frames.size());
  if (plan) line = places_on_line(flight, plan->mission);
  std::vector<Try> tries;
  double way_m = 0;
  std::optional<GeodeticPoint> before;
  for (std::size_t i = 0; i < flight.frames.size(); ++i) {
    const ReplayedFrame& frame = flight.frames[i];
    Try next;
    next.frame = &frame;
    next.line = line[i];
    next.too_unsure = scoring.max_prior_sigma_m && frame.prior_sigma_m > *scoring.max_prior_sigma_m;
    if (frame.place_from != PlaceSource::kNone) {
      if (before) way_m += geodesic_between(*before, frame.place).length_m;
      before = frame.place;
      next.tile = tiles.under(frame.place, frame.height_agl_m);
    }
    if (next.line) {
      const FlightSample& sample = plan->mission.flight.samples[next.line->sample];
      next.line_is_stored = tiles.under(sample.point, sample.agl_m).has_value();
    }
    // Blocks of one flight have numbers of their own.
    next.block = static_cast<std::int64_t>(number) * 1'000'000 + static_cast<std::int64_t>(way_m / scoring.block_m);
    tries.push_back(next);
  }
  return tries;
}

void count_try(const Try& one, TryCounts& fixes) {
  const ReplayedFrame& frame = *one.frame;
  if (!frame.is_tried()) {
    ++fixes.not_tried;
    return;
  }
  ++fixes.tries;
  if (frame.outcome == Outcome::kFalse) ++fixes.false_taken;
  if (frame.outcome == Outcome::kCorrect) ++fixes.right;
  if (frame.outcome == Outcome::kUnjudged) ++fixes.unjudged;
  if (frame.counts_as_right()) return;
  if (one.tile) {
    ++fixes.missed;
  } else if (one.line_is_stored) {
    ++fixes.off_line;
  } else {
    ++fixes.not_stored;
  }
}

/// Whether P says something of it: of one map, over a tile that has one.
bool has_p(const Try& one) {
  return one.frame->is_tried() && one.frame->map_count == 1 && one.tile && !std::isnan(one.tile->p());
}

bool is_predicted(const Try& one) {
  return has_p(one) && !one.too_unsure;
}

/// What many tries were promised, and gave.
struct Promised {
  double sum_p = 0;
  std::int64_t tries = 0;
  std::int64_t right = 0;
  double variance = 0;      ///< Of independent tries.
  double own_variance = 0;  ///< Of tries at a known level,
  double level_slope = 0;   ///< and how their sum moves with the level, in its standard deviations.

  void add(const Try& one) {
    const double p = one.tile->p();
    const double sigma = one.tile->scores.level_sigma;
    const double slope = std::isnan(sigma) ? 0 : p * (1 - p) * sigma;
    ++tries;
    if (one.frame->counts_as_right()) ++right;
    sum_p += p;
    variance += p * (1 - p);
    own_variance += std::max(0.0, p * (1 - p) - slope * slope);
    level_slope += slope;
  }
  double mean_p() const { return tries > 0 ? sum_p / static_cast<double>(tries) : kNaN; }
  double surplus() const { return static_cast<double>(right) - sum_p; }
};

std::optional<PredictedAgainstFlown> predicted_against_flown(const std::vector<Try>& tries,
                                                             const ReplayScoring& scoring) {
  Promised promised;
  std::vector<JudgedPrediction> predictions;
  for (const Try& one : tries) {
    if (!is_predicted(one)) continue;
    promised.add(one);
    predictions.push_back({one.tile->p(), one.frame->counts_as_right(), one.block});
  }
  if (predictions.empty()) return std::nullopt;
  PredictedAgainstFlown result;
  result.too_unsure =
      std::count_if(tries.begin(), tries.end(), [](const Try& one) { return has_p(one) && one.too_unsure; });
  result.tries = promised.tries;
  result.observed = {promised.right, promised.tries};
  result.predicted = promised.mean_p();
  QualityOptions options;
  options.seed = scoring.seed;
  options.threads = scoring.threads;
  result.quality = judge_predictions(predictions, true, options);
  if (promised.variance > 0) result.large_z = promised.surplus() / std::sqrt(promised.variance);
  const double with_level = promised.own_variance + promised.level_slope * promised.level_slope;
  if (with_level > 0) result.large_z_with_level = promised.surplus() / std::sqrt(with_level);
  return result;
}

double largest(const std::vector<double>& values) {
  return values.empty() ? kNaN : *std::max_element(values.begin(), values.end());
}

std::vector<FlownLeg> legs_of_plan(const std::vector<Try>& tries, const FlownPlan& plan) {
  std::vector<FlownLeg> legs;
  for (const LegStatus& status : plan.selection.legs) {
    FlownLeg leg;
    leg.leg = status.leg;
    leg.planned_p = status.p_within_limit;
    leg.planned_p_fix = status.p_fix;
    leg.planned_max_error_m = status.max_error_m;
    Promised promised;
    std::vector<double> errors_m;
    for (const Try& one : tries) {
      if (!one.line || one.line->leg != status.leg) continue;
      count_try(one, leg.fixes);
      if (is_predicted(one)) promised.add(one);
      if (one.frame->has_fix() && !std::isnan(one.frame->error_m)) errors_m.push_back(one.frame->error_m);
    }
    leg.predicted = promised.mean_p();
    leg.observed = {promised.right, promised.tries};
    leg.errors = std::ssize(errors_m);
    leg.median_error_m = quantile(errors_m, 0.5);
    leg.largest_error_m = largest(errors_m);
    legs.push_back(leg);
  }
  return legs;
}

FlownQuantity flown_quantity(const std::vector<Try>& tries, double (*value_of)(const LinePlace&)) {
  std::vector<double> values;
  std::vector<double> amounts;
  for (const Try& one : tries) {
    const double value = one.line ? value_of(*one.line) : kNaN;
    if (!std::isfinite(value)) continue;
    values.push_back(value);
    amounts.push_back(std::abs(value));
  }
  return {std::ssize(values), quantile(values, 0.5), quantile(amounts, 0.95), largest(amounts)};
}

FlownLine line_of(const std::vector<Try>& tries) {
  FlownLine line;
  for (const Try& one : tries) {
    if (one.frame->place_from == PlaceSource::kNone) continue;
    if (!one.line) {
      ++line.away;
      continue;
    }
    ++line.frames;
    if (one.line->beyond_corridor) ++line.beyond_corridor;
    if (one.line->beyond_heights) ++line.beyond_heights;
  }
  line.offset_m = flown_quantity(tries, [](const LinePlace& place) { return place.offset_m; });
  line.height_error_m = flown_quantity(tries, [](const LinePlace& place) { return place.height_error_m; });
  line.heading_error_deg = flown_quantity(tries, [](const LinePlace& place) { return place.heading_error_deg; });
  line.speed_ratio =
      flown_quantity(tries, [](const LinePlace& place) { return place.speed_mps / place.planned_speed_mps; });
  return line;
}

/// Frames over one tile in a row are one pass.
std::vector<TilePass> passes_of(const std::vector<Try>& tries) {
  std::vector<TilePass> passes;
  double nearest_m = 0;
  bool open = false;
  for (const Try& one : tries) {
    if (!is_predicted(one)) {
      // A frame that could not be tried does not end the pass; one over other ground does.
      open = open && one.frame->place_from != PlaceSource::kNone && one.tile &&
             one.tile->tile.tile_id == passes.back().tile.tile.tile_id;
      continue;
    }
    const double distance_m = geodesic_between(one.tile->tile.center, one.frame->place).length_m;
    const bool continues = open && one.tile->tile.tile_id == passes.back().tile.tile.tile_id;
    if (!continues) passes.push_back({*one.tile, one.block, "", "", Outcome::kRefused, kNaN, false});
    TilePass& pass = passes.back();
    if (!continues || distance_m < nearest_m) {
      nearest_m = distance_m;
      pass.file = one.frame->file;
      pass.status = one.frame->status;
      pass.outcome = one.frame->outcome;
      pass.error_m = one.frame->error_m;
    }
    pass.won = pass.won || one.frame->counts_as_right();
    open = true;
  }
  return passes;
}

std::vector<FlownTile> flown_tiles(const std::vector<TilePass>& passes) {
  std::map<std::int64_t, FlownTile> tiles;
  for (const TilePass& pass : passes) {
    const MapTile& tile = pass.tile.tile;
    FlownTile& flown =
        tiles.try_emplace(tile.tile_id, FlownTile{tile.tile_id, tile.center, pass.tile.p()}).first->second;
    ++flown.passes;
    if (pass.won) ++flown.won;
  }
  std::vector<FlownTile> list;
  for (const auto& [id, tile] : tiles) list.push_back(tile);
  return list;
}

void set_errors_of_fixes(const std::vector<Try>& tries, Replay& replay) {
  std::vector<double> errors_m;
  double nees = 0;
  std::int64_t judged = 0;
  for (const Try& one : tries) {
    const ReplayedFrame& frame = *one.frame;
    replay.has_truth = replay.has_truth || frame.place_from == PlaceSource::kTruth || !std::isnan(frame.error_m);
    if (frame.has_fix() && !std::isnan(frame.error_m)) errors_m.push_back(frame.error_m);
    if (frame.outcome != Outcome::kCorrect || std::isnan(frame.nees)) continue;
    nees += frame.nees;
    ++judged;
  }
  replay.median_error_m = quantile(errors_m, 0.5);
  replay.p95_error_m = quantile(errors_m, 0.95);
  const auto count = static_cast<double>(judged);
  replay.nees = {judged, kNaN, {kNaN, kNaN}};
  if (judged == 0) return;
  replay.nees = {judged,
                 nees / count,
                 {chi_squared_quantile(0.025, 2 * count) / count, chi_squared_quantile(0.975, 2 * count) / count}};
}

/// Frames of which it is known how sure navigation was and how far off. A fix ends a stretch, and so does a flight.
Integrity integrity_of(std::span<const ReplayedFlight> flights, double limit_m) {
  IntegrityCount count;
  for (const ReplayedFlight& flight : flights) {
    for (const ReplayedFrame& frame : flight.frames) {
      if (frame.has_fix()) count.end_stretch();
      if (std::isnan(frame.navigated_error_m)) continue;
      count.look(1, frame.navigated_sigma_m, frame.navigated_error_m, limit_m);
    }
    count.end_stretch();
  }
  return count.result(limit_m);
}

}  // namespace

Replay score_replay(std::span<const ReplayedFlight> flights, PredictedTiles& tiles,
                    const std::optional<FlownPlan>& plan, const std::optional<InsErrorModel>& model,
                    const ReplayScoring& scoring) {
  Replay replay;
  replay.correct_within_m = scoring.correct_within_m;
  replay.max_prior_sigma_m = scoring.max_prior_sigma_m;
  std::vector<Try> tries;
  for (std::size_t i = 0; i < flights.size(); ++i) {
    replay.flights.push_back(flights[i].name);
    if (i == 0) replay.priors = flights[i].priors;
    if (replay.priors != flights[i].priors) replay.priors = "mixed";
    for (const std::string& note : flights[i].notes) replay.notes.push_back(flights[i].name + ": " + note);
    const std::vector<Try> of_flight = tries_of(flights[i], i, tiles, plan, scoring);
    // A flight ends its last pass.
    const std::vector<TilePass> passes = passes_of(of_flight);
    replay.passes.insert(replay.passes.end(), passes.begin(), passes.end());
    tries.insert(tries.end(), of_flight.begin(), of_flight.end());
  }
  for (const Try& one : tries) count_try(one, replay.fixes);
  set_errors_of_fixes(tries, replay);
  replay.prediction = predicted_against_flown(tries, scoring);
  replay.contradictions = find_contradictions(flown_tiles(replay.passes));
  if (plan) {
    replay.legs = legs_of_plan(tries, *plan);
    const FlownLine line = line_of(tries);
    if (line.away > line.frames) {
      replay.notes.push_back("not flown along the planned line: " + std::to_string(line.away) + " of " +
                             std::to_string(line.away + line.frames) +
                             " frames lie farther from it than anything planned; offset, height, heading and speed are "
                             "of the others");
    }
    replay.line = line;
    replay.integrity = integrity_of(flights, plan->selection.max_error_m);
    if (plan->selection.probability) replay.planned_p = plan->selection.probability->p_within_limit;
  }
  if (model) replay.grade = fit_grade(flights, *model);
  return replay;
}

}  // namespace pilotage
