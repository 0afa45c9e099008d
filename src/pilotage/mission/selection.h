#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#pragma GCC visibility push(default)

namespace pilotage {

/// A stretch of the route over which the aircraft has no GNSS and gets no fix.
struct RouteGap {
  int leg = 0;                 ///< Leg on which it starts.
  double from_distance_m = 0;  ///< Along the route.
  double to_distance_m = 0;
  double duration_s = 0;
  double error_m = 0;  ///< Predicted error (k·σ) at its end.
  bool within_limit = true;
  /// P that the error first exceeds its limit in this gap; NaN without probabilities.
  double p_first_excess = std::numeric_limits<double>::quiet_NaN();
};

struct LegStatus {
  int leg = 0;
  double length_m = 0;
  double matchable_fraction = 0;  ///< Share of its length over selected tiles.
  double max_error_m = 0;         ///< Largest predicted error on it (k·σ).
  bool within_limit = true;
  /// P that the error stays within its limit on the leg, given that it did up to the leg; the route's is the product of
  /// its legs'. NaN without probabilities, and where no flight reaches the leg within the limit.
  double p_within_limit = std::numeric_limits<double>::quiet_NaN();
  /// P of at least one correct fix on the leg before the error exceeds its limit, given the same; NaN as above.
  double p_fix = std::numeric_limits<double>::quiet_NaN();
};

/// Predicted error along the route, for the strip chart.
struct ErrorSample {
  double distance_m = 0;
  double error_m = 0;
  bool matchable = false;
  /// P that a frame here gives a correct fix: of the stored tile, 0 without one; NaN without probabilities.
  double p_correct_fix = std::numeric_limits<double>::quiet_NaN();
  /// P that the error has stayed within its limit up to here; NaN without probabilities.
  double p_within_limit = std::numeric_limits<double>::quiet_NaN();
};

/// Where most flights are lost: from their last fixes, or the loss of GNSS, to where their error is beyond its limit.
struct WorstStretch {
  int leg = 0;                 ///< Leg on which they are lost.
  double from_distance_m = 0;  ///< Along the route.
  double to_distance_m = 0;
  double p_first_excess = 0;  ///< P that the error first exceeds its limit so.
};

/// The P of the route where the level of the place lies at the ends of its 80 % interval (ground/place_level.h),
/// widened to hold the mean over all levels.
struct ProbabilityInterval {
  double low = 0;
  double high = 0;
};

/// What the flight's chances are, where the tiles' P of a correct fix are known (docs/methods/selection.md).
struct RouteProbability {
  double p_within_limit = 0;          ///< P that the error stays within its limit from start to end, over all levels.
  double min_p_within_limit = 0;      ///< What was asked for; the verdict is held against it.
  double expected_fixes = 0;          ///< Correct fixes on the flight, one try every fix interval.
  double expected_false_fixes = 0;    ///< Upper bound, by the rate of false fixes that the matcher promises.
  std::optional<WorstStretch> worst;  ///< Nothing when no flight is lost.
  /// Nothing where the tiles do not say how well the level of their place is known.
  std::optional<ProbabilityInterval> interval;
  /// Tiles of this ground, judged on another date, that the level rests on; 0: it rests on other places; NaN: nothing
  /// is said.
  double level_tiles = std::numeric_limits<double>::quiet_NaN();
  /// Age of the imagery that the level counts; NaN: it counts none.
  double level_age_months = std::numeric_limits<double>::quiet_NaN();
};

/// What the P of a route rests on, in a sentence without its full stop: one date of this ground, or two; "" where its
/// tiles do not say.
std::string rests_on_text(const RouteProbability& probability);

/// What the flight's chances are over imagery of some age.
struct ChancesAtAge {
  double age_months = 0;  ///< Of the raster that is farthest from the flight.
  double p_within_limit = 0;
  ProbabilityInterval interval;  ///< As RouteProbability::interval.
};

/// How the chances fall when the same map is flown later, by what the default model takes from P for the age of
/// imagery: a rule of thumb (matchability/level_at_age.h).
struct RouteAgeing {
  std::vector<ChancesAtAge> ages;  ///< Ascending; the first is the planned flight's.
  /// The greatest age up to which P is what was asked for: from the planned flight's on, or of younger imagery where it
  /// is less there. Nothing: at no age. kMostAge_months: as far as anything is known.
  std::optional<double> enough_up_to_months;
  std::optional<double> surely_up_to_months;  ///< The same of the lower end of the interval.
};

enum class AdviceSide { kNone, kLeft, kRight };

/// What would make a leg good that is not: the nearest parallel line on which it is, else the best one.
struct LegAdvice {
  int leg = 0;
  AdviceSide side = AdviceSide::kNone;  ///< Seen in the direction of flight; kNone with offset 0.
  double offset_m = 0;                  ///< How far aside. 0: the line itself, with every tile that can be matched.
  double p_before = 0;                  ///< LegStatus::p_within_limit of the selection.
  double p_after = 0;
  bool good = false;  ///< p_after reaches the limit that was asked for.
};

/// Why tiles are not stored, as far as no score says it.
struct LeftOut {
  double min_p_correct_fix = 0;             ///< What a tile whose P is known needed,
  double min_peak_margin = 0;               ///< and the margin of one whose P is not.
  std::vector<std::int64_t> beyond_budget;  ///< Tiles that would have been stored in a larger map. Ascending.
};

/// When a flight tries to fix, as the prediction takes it.
struct FixTries {
  double interval_s = 0;                  ///< No fix comes sooner after another.
  std::optional<double> decorrelation_m;  ///< Way over which tries fare alike; nothing: the width of a tile.
  double false_fix_rate = 0.001;  ///< Of the tries that find no right place, those that find a false one, at most.
};

/// What comes of losing GNSS at one point of the route for good.
struct LossPoint {
  double distance_m = 0;  ///< Along the route.
  int leg = 0;
  double max_error_m = 0;  ///< Largest predicted error (k·σ).
  /// P that the error stays within its limit to the route's end; NaN without probabilities.
  double p_within_limit = std::numeric_limits<double>::quiet_NaN();
};

/// The loss of GNSS at whatever point. The flight that the selection predicts is that of the worst.
struct LossAnywhere {
  std::vector<LossPoint> points;  ///< Those that were looked at, in the order of the route; at least one.
  std::size_t worst = 0;          ///< Index of the one that decides.
  double step_m = 0;              ///< The longest way between two of them, or from the last to the route's end.
};

/// What `select` decides: which tiles are stored, and what the route looks like with them.
struct Selection {
  std::vector<std::int64_t> tile_ids;  ///< Ascending.
  std::vector<RouteGap> gaps;
  std::vector<LegStatus> legs;
  std::vector<ErrorSample> error_profile;
  double matchable_fraction = 0;    ///< Of the whole route's length.
  double max_error_m = 0;           ///< The limit that was asked for.
  double sigma_multiple = 3;        ///< k of k·σ.
  bool within_limit = true;         ///< No gap lets the error exceed the limit.
  bool matchability_judged = true;  ///< A stored tile has a P or a margin: false where nothing says that any is found.
  std::int64_t estimated_bytes = 0;
  std::optional<RouteProbability> probability;  ///< Nothing when no tile has a P.
  std::optional<RouteAgeing> ageing;            ///< Where it was asked for and P counts the age of the imagery.
  std::optional<LossAnywhere> loss_anywhere;    ///< Where the plan says that GNSS may be lost anywhere.
  std::vector<LegAdvice> advice;                ///< One for each leg that is not good enough, when asked for.
  std::vector<std::string> notes;
  std::optional<LeftOut> left_out;  ///< Nothing where a selection was not made by `select`.
  std::optional<FixTries> tries;    ///< The same.
};

/// "0.987": three decimals, rounded down, so that what is not certain never reads 1.000; "–" for NaN.
std::string probability_text(double p);

/// Whether the flight may go: tiles were judged by more than their status, within_limit, and the route's probability,
/// where there is one, is what was asked for.
inline bool meets_gate(const Selection& selection) {
  return selection.matchability_judged && selection.within_limit &&
         (!selection.probability || selection.probability->p_within_limit >= selection.probability->min_p_within_limit);
}

}  // namespace pilotage

#pragma GCC visibility pop
