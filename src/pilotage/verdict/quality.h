#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pilotage/ground/tile_scores.h"
#include "pilotage/mission/mission.h"
#include "pilotage/mission/selection.h"
#include "pilotage/mission/simulation.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// What a number rests on.
enum class NumberKind {
  kMeasured,   ///< On the imagery, or on flights.
  kSimulated,  ///< By flights or frames that were computed with drawn errors.
  kModelled,   ///< By a formula: the inertial error model, or a fitted P.
  kStated,     ///< By the mission or the plan: nothing was found out.
};

enum class QualityStatus { kGood, kMarginal, kBad };

/// "good", "marginal", "bad"
std::string_view status_name(QualityStatus status);

/// "GO", "MARGINAL", "NO-GO"
std::string_view verdict_name(QualityStatus status);

/// One line of the quality table: a number beside the thresholds it is judged by.
struct QualityRow {
  std::string name;   ///< For machines: "largest_error".
  std::string label;  ///< For people.
  double number = std::numeric_limits<double>::quiet_NaN();
  std::string unit;
  std::string value;      ///< The number for people, with its unit.
  std::string threshold;  ///< What is good, marginal and bad.
  QualityStatus status = QualityStatus::kGood;
  bool decides = false;                   ///< Only rows that decide enter the verdict; the others give advice.
  std::string advice;                     ///< What to do about it; "" when it is good.
  NumberKind kind = NumberKind::kStated;  ///< Not part of report.json.
};

/// The published thresholds. Where they come from stands in docs/methods/report.md.
struct QualityThresholds {
  static constexpr double kErrorShareGood = 0.8;  ///< Largest error as a share of the limit.
  static constexpr double kMatchableGood = 0.5;   ///< Share of the route's length over selected tiles.
  static constexpr double kCoverageGood = 0.99;   ///< Share of the corridor that the imagery covers.
  static constexpr double kCoverageMarginal = 0.9;
  static constexpr double kDistortionGood = 0.001;  ///< |scale − 1| of the mission grid.
  static constexpr double kDistortionMarginal = 0.005;
  static constexpr double kGsdFinest_m = 0.5;  ///< Ground sample distances that match best across dates.
  static constexpr double kGsdCoarsest_m = 1.0;
  static constexpr double kFootprintPixelsGood = 256;  ///< Map pixels across the camera's footprint.
  static constexpr double kFootprintPixelsMarginal = 128;
  static constexpr double kScoredGood = 0.95;  ///< Share of the tiles that could be scored.
  static constexpr double kScoredMarginal = 0.8;
};

/// Judges a number of which more is better; NaN is bad.
QualityStatus judge_at_least(double number, double good, double marginal);

/// Judges a predicted error against the limit: good up to 80 % of it, marginal up to it, bad beyond or when NaN.
QualityStatus judge_error(double error_m, double limit_m);

/// Judges the probability of staying within the limit against the one that was asked for: bad below it, marginal below
/// the middle between it and 1. Good when none was asked for; bad when NaN, which no flight reaches within the limit.
QualityStatus judge_probability(double p_within_limit, const Selection& selection);

/// How good a leg is: the worse of its largest error and of its probability of staying within the limit.
QualityStatus judge_leg(const LegStatus& leg, const Selection& selection);

/// How good a stretch without a fix is: the worst of the error at its end, of its probability of being lost in it, and
/// bad where it lies in the stretch that loses most flights of a route that too few survive.
QualityStatus judge_gap(const RouteGap& gap, const Selection& selection);

/// Judges the P of the whole route: bad where its mean over the levels of the place is below what was asked for,
/// marginal where only the lower end of its 80 % interval is: at one place of ten or more P is below it.
QualityStatus judge_route(const RouteProbability& route);

/// What a marginal P of the route is marginal by.
inline constexpr const char* kIntervalBelow = "P is below what is asked for at the lower end of its 80 % interval";

/// Whether fewer flights stay within the limit than were asked for.
bool too_often_lost(const Selection& selection);

/// Largest predicted error of the profile, the gaps and the legs; NaN when one of them is NaN or there is none.
double largest_error_m(const Selection& selection);

/// The longest gap, the first of equal ones; nullptr without one.
const RouteGap* longest_gap(const Selection& selection);

/// "3.4 km = 122 s at 28 m/s"
std::string gap_text(const RouteGap& gap);

/// "0.982 ≥ 0.900" or "0.873 < 0.900"
std::string probability_comparison(const RouteProbability& route);

/// What flights that were flown say of the P that the plan rests on. Of replay.json.
struct FlownAgainstPlan {
  std::int64_t tries = 0;          ///< Over stored tiles, with priors that P is of;
  std::int64_t fixes = 0;          ///< those that gave a fix which is not known to be false;
  double predicted = 0;            ///< and the share of them that was predicted.
  double z = 0;                    ///< Fixes less predicted ones in standard deviations, were tries independent;
  double z_with_level = 0;         ///< and with the level of the place, which all tries share.
  std::int64_t without_right = 0;  ///< Tries of the whole flight that gave no right fix;
  std::int64_t false_taken = 0;    ///< those of them that gave a false one.
};

/// What a plan is judged by. It only refers to what it is given.
struct JudgedPlan {
  const Mission& mission;
  const std::vector<TileScores>& scores;  ///< Of the ground's tiles, in their order.
  const Selection& selection;
  std::span<const Simulation> simulations = {};  ///< What `simulate` found of this plan.
  const FlownAgainstPlan* flown = nullptr;       ///< What `replay` found of flights by it; may be null.
};

/// The quality table. Throws DataError when the time of the flight is neither a day nor a moment in UTC, the flight has
/// a time and no sample, or the selection counts the age of imagery whose dates the ground does not all know.
std::vector<QualityRow> quality_rows(const JudgedPlan& plan);

}  // namespace pilotage

#pragma GCC visibility pop
