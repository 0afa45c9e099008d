#include "pilotage/select/route_ageing.h"

#include <algorithm>
#include <cmath>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/ground/imagery_months.h"
#include "pilotage/ground/score_table.h"
#include "pilotage/ground/tile_chances.h"
#include "pilotage/matchability/level_at_age.h"
#include "pilotage/select/fix_attempts.h"
#include "pilotage/select/planned_flight.h"
#include "pilotage/select/route_probability.h"

namespace pilotage {
namespace {

constexpr double kLater_months[] = {6, 12, 24, 48};

/// The age that the P of all stored tiles counts, where it only grows on later flights, and something is known of
/// these.
std::optional<double> growing_age_months(const Mission& mission, const std::vector<TileScores>& scores,
                                         const std::vector<bool>& stored) {
  constexpr double kSameAge_months = 0.01;
  const auto counted_months = counted_age_months(scores, stored);
  const auto planned_months = imagery_months(mission.ground);
  if (!counted_months) return std::nullopt;
  if (!planned_months) {
    throw DataError(
        "the scores count imagery " + format_fixed(*counted_months, 2) +
        " months old, and the plan does not know when it is flown, or a date of its imagery: score the plan "
        "again");
  }
  if (std::abs(*counted_months - *planned_months) > kSameAge_months) {
    throw DataError("the scores count imagery " + format_fixed(*counted_months, 2) +
                    " months old, on the plan's flight it is " + format_fixed(*planned_months, 2) +
                    ": score the plan again");
  }
  const bool is_known_of_later = ageing_imagery(mission.ground) && *planned_months < kMostAge_months;
  return is_known_of_later ? planned_months : std::nullopt;
}

/// The flight of a selection, predicted with imagery of any age.
class AgedFlight {
 public:
  AgedFlight(const Mission& mission, const std::vector<TileScores>& scores, const Selection& selection, int threads)
      : mission_(mission),
        scores_(scores),
        stored_(stored_tiles(mission, selection)),
        tries_(*selection.tries),
        path_(make_flight_path(mission, selection.max_error_m, tile_chances(scores, stored_).levels.size())),
        attempts_(fix_attempts(mission, tiles_under_route(mission), tries_.interval_s, tries_.decorrelation_m)),
        threads_(threads) {
    path_.gnss = planned_gnss(mission, selection);
  }

  ChancesAtAge at(double age_months) const {
    std::vector<TileScores> aged = scores_;
    for (std::size_t i = 0; i < aged.size(); ++i) {
      if (stored_[i]) move_to_age(aged[i], age_months);
    }
    const std::vector<LevelChances> chances =
        level_chances(mission_, mission_.flight.samples, attempts_, tile_chances(aged, stored_), tries_);
    const RouteSurvival survival = predict_survival(path_, chances, threads_);
    const double p = survival.p_within_limit.back();
    return {age_months, p, interval_over_levels(survival).value_or(ProbabilityInterval{p, p})};
  }

 private:
  const Mission& mission_;
  const std::vector<TileScores>& scores_;
  std::vector<bool> stored_;
  FixTries tries_;
  FlightPath path_;
  std::vector<FixAttempt> attempts_;
  int threads_;
};

/// What of the chances is held against what was asked for.
using Figure = double (*)(const ChancesAtAge&);

double p_of(const ChancesAtAge& at) {
  return at.p_within_limit;
}

double low_of(const ChancesAtAge& at) {
  return at.interval.low;
}

/// The age between two at which a figure comes down to what was asked for; one prediction in between.
double age_between(const AgedFlight& flight, ChancesAtAge younger, ChancesAtAge older, Figure figure,
                   double asked_for) {
  const auto on_the_line = [&] {
    const double share = (figure(younger) - asked_for) / (figure(younger) - figure(older));
    const double from_months = std::max(younger.age_months, kLeastAge_months);
    return from_months * std::pow(older.age_months / from_months, share);
  };
  const ChancesAtAge between = flight.at(on_the_line());
  (figure(between) >= asked_for ? younger : older) = between;
  return on_the_line();
}

/// The age up to which a figure is what was asked for. It is at the first of the ages, which are ascending.
double enough_up_to(const AgedFlight& flight, const std::vector<ChancesAtAge>& ages, Figure figure, double asked_for) {
  for (std::size_t i = 1; i < ages.size(); ++i) {
    if (figure(ages[i]) < asked_for) return age_between(flight, ages[i - 1], ages[i], figure, asked_for);
  }
  const ChancesAtAge most = flight.at(kMostAge_months);
  return figure(most) >= asked_for ? kMostAge_months : age_between(flight, ages.back(), most, figure, asked_for);
}

/// The age of younger imagery with which P is what was asked for; nothing where none is young enough.
std::optional<double> enough_when_younger(const AgedFlight& flight, ChancesAtAge older, double asked_for) {
  while (older.age_months > kLeastAge_months) {
    const ChancesAtAge younger = flight.at(std::max(older.age_months / 2, kLeastAge_months));
    if (p_of(younger) >= asked_for) return age_between(flight, younger, older, p_of, asked_for);
    older = younger;
  }
  return std::nullopt;
}

}  // namespace

std::optional<RouteAgeing> age_route(const Mission& mission, const std::vector<TileScores>& scores,
                                     const Selection& selection, int threads) {
  ScoreTable(mission.ground, scores);  // one for each tile
  if (!selection.probability || !selection.probability->interval || !selection.tries) return std::nullopt;
  const auto counted = growing_age_months(mission, scores, stored_tiles(mission, selection));
  if (!counted) return std::nullopt;
  const RouteProbability& planned = *selection.probability;
  const double asked_for = planned.min_p_within_limit;
  const AgedFlight flight(mission, scores, selection, threads);
  RouteAgeing ageing;
  ageing.ages.push_back({*counted, planned.p_within_limit, *planned.interval});
  for (const double later_months : kLater_months) {
    const double age_months = *counted + later_months;
    if (age_months > kMostAge_months) break;
    ageing.ages.push_back(flight.at(age_months));
  }
  const ChancesAtAge& now = ageing.ages.front();
  ageing.enough_up_to_months = p_of(now) >= asked_for ? enough_up_to(flight, ageing.ages, p_of, asked_for)
                                                      : enough_when_younger(flight, now, asked_for);
  if (low_of(now) >= asked_for) ageing.surely_up_to_months = enough_up_to(flight, ageing.ages, low_of, asked_for);
  return ageing;
}

}  // namespace pilotage
