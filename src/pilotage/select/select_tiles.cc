#include "pilotage/select/select_tiles.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/text.h"
#include "pilotage/matchability/level_at_age.h"
#include "pilotage/select/budget_tiles.h"
#include "pilotage/select/byte_budget.h"
#include "pilotage/select/fix_attempts.h"
#include "pilotage/select/leg_advice.h"
#include "pilotage/select/route_error.h"
#include "pilotage/select/route_probability.h"
#include "pilotage/select/storage_count.h"
#include "pilotage/select/worst_loss.h"

namespace pilotage {
namespace {

std::vector<bool> samples_over(const std::vector<std::optional<std::size_t>>& tiles, const std::vector<bool>& chosen) {
  std::vector<bool> over(tiles.size());
  for (std::size_t i = 0; i < over.size(); ++i) over[i] = tiles[i] && chosen[*tiles[i]];
  return over;
}

// The matching areas around the fixes: every matchable tile in which the aircraft may find itself there.
std::vector<bool> sparse_areas(const Mission& mission, const std::vector<bool>& matchable,
                               const std::vector<bool>& can_fix, double max_error_m) {
  std::vector<bool> chosen(mission.ground.tiles.size(), false);
  for (const std::size_t fix : fewest_fix_samples(mission, can_fix, max_error_m)) {
    const FlightSample& sample = mission.flight.samples[fix];
    const TileMatrix& matrix = mission.ground.levels[static_cast<std::size_t>(sample.level)].matrix;
    // Half the diagonal of a stride more, so that the tile of the fix is among them however narrow the corridor.
    const double half_diagonal_m = std::sqrt(0.5) * matrix.stride_px * matrix.map_from_pixel.x_per_col;
    const double reach_m = mission.flight.corridor_half_width_m + half_diagonal_m;
    for (std::size_t i = 0; i < mission.ground.tiles.size(); ++i) {
      const GroundTile& tile = mission.ground.tiles[i];
      if (tile.level != sample.level || !matchable[i]) continue;
      if ((tile.bounds.center_m() - sample.point_map_m).norm() <= reach_m) chosen[i] = true;
    }
  }
  return chosen;
}

std::size_t count_true(const std::vector<bool>& flags) {
  return static_cast<std::size_t>(std::count(flags.begin(), flags.end(), true));
}

// What the selection knows beside the tiles it chooses.
struct Chances {
  FlightPath path;
  std::vector<FixAttempt> attempts;         // with GNSS or without
  std::vector<FixAttempt> needed_attempts;  // where GNSS is denied: a budget is spent there first
  TileChances of_tiles;                     // of the matchable ones
  FixTries tries;
  int threads = 1;

  std::vector<LevelChances> along(const std::vector<bool>& chosen) const {
    return level_chances(*path.mission, path.mission->flight.samples, attempts, of_chosen(of_tiles, chosen), tries);
  }
  RouteSurvival of(const std::vector<bool>& chosen, double entries_below = 0) const {
    return predict_survival(path, along(chosen), threads, entries_below);
  }
};

// "GNSS may be lost anywhere, for good: …", for the planner.
std::string loss_note(const LossAnywhere& loss) {
  const auto place = [](const LossPoint& point) {
    return format_fixed(point.distance_m / 1000, 2) + " km (leg " + std::to_string(point.leg + 1) + ")";
  };
  const LossPoint& worst = loss.points[loss.worst];
  const LossPoint& farthest_off =
      *std::max_element(loss.points.begin(), loss.points.end(),
                        [](const LossPoint& a, const LossPoint& b) { return a.max_error_m < b.max_error_m; });
  const std::string points = std::to_string(loss.points.size()) + " points, at most " + format_fixed(loss.step_m, 0) +
                             " m apart, were looked at; the worst is " + place(worst) + ": ";
  std::string text = "GNSS may be lost anywhere, for good: " + points;
  if (!std::isnan(worst.p_within_limit)) text += "P = " + probability_text(worst.p_within_limit) + ", ";
  text += "largest error " + format_fixed(worst.max_error_m, 1) + " m";
  if (format_fixed(farthest_off.max_error_m, 1) != format_fixed(worst.max_error_m, 1)) {
    text += "; the largest of all, " + format_fixed(farthest_off.max_error_m, 1) + " m, comes of its loss at " +
            place(farthest_off);
  }
  return text + "; fixes are taken where it is had, too";
}

// The better of the stated order and of the search for the largest P; the order where they are alike.
std::vector<bool> within_budget(const Chances& chances, const std::vector<TileScores>& scores,
                                const std::vector<bool>& wanted, const std::vector<bool>& sparse,
                                const StoredSize& size, std::int64_t budget) {
  const Mission& mission = *chances.path.mission;
  const std::vector<bool> none(wanted.size(), false);
  std::vector<bool> best = tiles_in_order(mission, scores, wanted, sparse, none, size, budget);
  const auto worth = [&](const std::vector<bool>& chosen) { return flight_worth(chances.of(chosen).p_within_limit); };
  double best_worth = worth(best);
  const TileChances of_wanted = of_chosen(chances.of_tiles, wanted);
  const auto improve = [&](const std::vector<bool>& start, const std::vector<bool>& history, bool flown) {
    const std::vector<bool> under_route =
        most_probable_tiles(chances.path, chances.needed_attempts, of_wanted, start, history, size, budget,
                            chances.tries, flown, chances.threads);
    const std::vector<bool> filled = tiles_in_order(mission, scores, wanted, sparse, under_route, size, budget);
    const double filled_worth = worth(filled);
    if (filled_worth <= best_worth) return;
    best = filled;
    best_worth = filled_worth;
  };
  // How far a flight gets after a fix is taken from flights over all wanted tiles first, which may be more than fit,
  // then from flights over the best set so far.
  improve(best, wanted, false);
  improve(none, wanted, false);
  improve(none, std::vector<bool>(best), false);
  improve(std::vector<bool>(best), std::vector<bool>(best), true);
  return best;
}

void add_chances(const Chances& chances, const std::vector<bool>& chosen,
                 const std::vector<std::optional<std::size_t>>& tiles, const SelectOptions& options,
                 Selection& selection) {
  const RouteSurvival survival = chances.of(chosen, options.advise ? options.min_leg_probability : 0);
  const Mission& mission = *chances.path.mission;
  const std::vector<double> p_of_stored = of_chosen(chances.of_tiles, chosen).p;
  const ExpectedFixes expected = expected_fixes(mission, tiles, chosen, p_of_stored, chances.tries);
  selection.probability = RouteProbability{survival.p_within_limit.back(),
                                           options.min_route_probability,
                                           expected.correct,
                                           expected.wrong,
                                           survival.worst,
                                           {}};
  selection.probability->interval = interval_over_levels(survival);
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    selection.error_profile[i].p_correct_fix = tiles[i] ? p_of_stored[*tiles[i]] : 0;
    selection.error_profile[i].p_within_limit = survival.p_within_limit[i];
  }
  for (LegStatus& leg : selection.legs) {
    leg.p_within_limit = survival.leg_p_within_limit[static_cast<std::size_t>(leg.leg)];
    leg.p_fix = survival.leg_p_fix[static_cast<std::size_t>(leg.leg)];
  }
  const auto p_at = [&](double distance_m) {  // after the first of two samples at one place
    const auto sample = std::lower_bound(mission.flight.samples.begin(), mission.flight.samples.end(), distance_m,
                                         [](const FlightSample& a, double b_m) { return a.distance_m < b_m; });
    return survival.p_within_limit[static_cast<std::size_t>(sample - mission.flight.samples.begin())];
  };
  for (RouteGap& gap : selection.gaps) {
    const double before = gap.from_distance_m > 0 ? p_at(gap.from_distance_m) : 1;
    gap.p_first_excess = before - p_at(gap.to_distance_m);
  }
  if (!options.advise) return;
  selection.advice = advise_legs(chances.path, survival, chances.of_tiles,
                                 {chances.tries, options.min_leg_probability, chances.threads});
  for (const LegAdvice& advice : selection.advice) {
    selection.notes.push_back(advice_text(advice, options.min_leg_probability, mission.flight.corridor_half_width_m));
  }
}

}  // namespace

bool is_matchable(const TileScores& score, const SelectOptions& options) {
  return can_be_matched(score, options.min_p_correct_fix, options.min_peak_margin);
}

Selection select_tiles(const Mission& mission, const std::vector<TileScores>& scores, const StoredSize& size,
                       const SelectOptions& options, int threads) {
  check_options(options);
  const double max_error_m = mission.flight.max_error_m;
  ScoreTable(mission.ground, scores);  // one for each tile
  const std::vector<std::optional<std::size_t>> tiles = tiles_under_route(mission);

  std::vector<bool> matchable(mission.ground.tiles.size());
  for (std::size_t i = 0; i < matchable.size(); ++i) matchable[i] = is_matchable(scores[i], options);
  const std::vector<bool> sparse = sparse_areas(mission, matchable, samples_over(tiles, matchable), max_error_m);
  const std::vector<bool> wanted = options.sparse ? sparse : matchable;
  std::vector<bool> chosen = wanted;
  const FixTries tries{options.fix_interval_s, options.fix_decorrelation_m, options.max_false_fix_rate};
  std::optional<Chances> chances;
  if (any_p_known(scores)) {
    const auto attempts = [&](const std::vector<std::optional<std::size_t>>& over) {
      return fix_attempts(mission, over, options.fix_interval_s, options.fix_decorrelation_m);
    };
    TileChances of_tiles = tile_chances(scores, matchable);
    FlightPath path = make_flight_path(mission, max_error_m, of_tiles.levels.size());
    chances = Chances{
        std::move(path),     attempts(tiles), attempts(tiles_without_gnss(tiles, gnss_availability(mission.flight))),
        std::move(of_tiles), tries,           threads};
  }
  if (options.budget) {
    const std::int64_t budget = parse_byte_budget(*options.budget);
    const std::vector<bool> none(chosen.size(), false);
    chosen = chances ? within_budget(*chances, scores, chosen, sparse, size, budget)
                     : tiles_in_order(mission, scores, chosen, sparse, none, size, budget);
  }

  Selection selection;
  selection.tries = tries;
  selection.left_out = LeftOut{options.min_p_correct_fix, options.min_peak_margin, {}};
  StorageCount count(mission, size);
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (wanted[i] && !chosen[i]) selection.left_out->beyond_budget.push_back(mission.ground.tiles[i].tile_id);
    if (!chosen[i]) continue;
    selection.tile_ids.push_back(mission.ground.tiles[i].tile_id);
    count.add(mission.ground.tiles[i]);
  }
  const std::vector<bool> stored = samples_over(tiles, chosen);
  GnssAvailability gnss = gnss_availability(mission.flight);
  if (mission.flight.denied.anywhere) {
    const LossAnywhere loss = lose_gnss_anywhere(mission, stored, chances ? &chances->path : nullptr,
                                                 chances ? chances->along(chosen) : std::vector<LevelChances>{},
                                                 max_error_m, options.fix_interval_s, threads);
    gnss = gnss_lost_at(mission.flight, loss.points[loss.worst].distance_m);
    if (chances) chances->path.gnss = gnss;
    selection.loss_anywhere = loss;
  }
  RouteError error = predict_route_error(mission, gnss, stored, max_error_m, options.fix_interval_s);
  selection.gaps = std::move(error.gaps);
  selection.legs = std::move(error.legs);
  selection.error_profile = std::move(error.profile);
  selection.matchable_fraction = error.matchable_fraction;
  selection.within_limit = error.within_limit;
  selection.max_error_m = max_error_m;
  selection.sigma_multiple = mission.flight.ins.sigma_multiple;
  selection.estimated_bytes = static_cast<std::int64_t>(std::ceil(count.bytes()));
  selection.notes.push_back(std::to_string(count_true(matchable)) + " of " +
                            std::to_string(mission.ground.tiles.size()) + " tiles can be matched; " +
                            std::to_string(selection.tile_ids.size()) + " are stored");
  if (selection.loss_anywhere) selection.notes.push_back(loss_note(*selection.loss_anywhere));
  selection.matchability_judged = selection.tile_ids.empty();
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const bool judged = !std::isnan(scores[i].p_correct_fix) || !std::isnan(judged_margin(scores[i]));
    if (chosen[i] && judged) selection.matchability_judged = true;
  }
  if (!selection.matchability_judged) {
    selection.notes.emplace_back(
        "not judged: no stored tile has a probability of a correct fix or a margin, so nothing says whether any is "
        "found; score with the measure correct_fix, or degraded");
  }
  if (chances) {
    if (const std::size_t without_p = tiles_without_p(scores, chosen); without_p > 0) {
      selection.notes.push_back(std::to_string(without_p) +
                                " stored tiles have no probability of a correct fix; they were counted as certain");
    }
    add_chances(*chances, chosen, tiles, options, selection);
    selection.probability->level_tiles = fewest_level_tiles(scores, chosen);
    const std::vector<bool>& told = selection.tile_ids.empty() ? std::vector<bool>(scores.size(), true) : chosen;
    selection.probability->level_age_months = counted_age_months(scores, told).value_or(kNaN);
  } else if (options.advise) {
    selection.notes.push_back("no tile has a probability of a correct fix, so no leg can be advised on");
  }
  return selection;
}

}  // namespace pilotage
