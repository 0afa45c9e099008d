#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "pilotage/ins/ins_error_model.h"

namespace pilotage {

/// A piece of a line, and what can be found on the ground under it.
struct FlownStep {
  float length_m = 0;
  float p = 0;  ///< P of a correct fix of a try there; 0 where none can be had.
};

/// The search's own model of a flight without GNSS (docs/methods/reroute.md): the position error depends on nothing but
/// the way flown since the last fix.
struct FixAgeModel {
  double bin_m = 1;             ///< Ages are counted in these.
  std::size_t bins = 1;         ///< 1 … FixAges::kMostBins; a flight older than the last is lost.
  double window_m = 1;          ///< Way over which tries succeed or fail together.
  double start_age_m = 0;       ///< What the loss of GNSS is worth as an age: less is left to fly than after a fix.
  double good_reach_m = 0;      ///< Longest way without matchable ground for which the predicted error is good.
  double start_good_age_m = 0;  ///< As start_age_m, of good_reach_m.
};

/// What a step does to ages by a model, computed once for steps that are flown often.
struct AgeStep {
  float length_m = 0;
  std::uint32_t bins = 0;  ///< By so many whole bins flights grow older,
  float bin_part = 0;      ///< and this share of them by one more.
  bool matchable = false;  ///< A fix can be had there,
  float fixed = 0;         ///< and comes to this share: 1 − (1 − p)^(length / window).
};

/// The model of a flight at `speed_mps`: a flight that has had `fixes_before` fixes, one a window, reaches `limit_m`
/// after bins · bin_m. `step_m` is how finely lines are flown.
/// All arguments positive; `good_share` of the limit is what the verdict calls good.
FixAgeModel make_fix_age_model(const InsErrorModel& model, double speed_mps, double limit_m, double good_share,
                               double window_m, double step_m, int fixes_before);

/// Flights on a line, by the way flown since their last fix: within[a] is the share of all that are within the limit
/// and had it at most a + 1 bins ago. Never falls with a; the last is the share within the limit.
struct FixAges {
  static constexpr std::size_t kMostBins = 40;
  std::array<float, kMostBins> within{};
  float since_matchable_m = 0;  ///< Of a flight that gets a fix wherever one can be had.
};

/// All flights at the loss of GNSS.
FixAges ages_at_start(const FixAgeModel& model);

AgeStep age_step(const FixAgeModel& model, const FlownStep& step);

/// All grow older by a step's length, then a fix comes to a share of them. Every entry of `within` afterwards
/// is a sum of entries before with weights that are not negative, which is what makes dominance exact.
void take_step(const FixAgeModel& model, const AgeStep& step, FixAges& ages);
inline void fly_step(const FixAgeModel& model, const FlownStep& step, FixAges& ages) {
  take_step(model, age_step(model, step), ages);
}

/// The share of the flights that are within the limit.
inline float share_within(const FixAgeModel& model, const FixAges& ages) {
  return ages.within[model.bins - 1];
}

}  // namespace pilotage
