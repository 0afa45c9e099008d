#pragma once

#include <string>

#include "pilotage/matchability/matchability_model.h"

// How the level of a place moves with the time between the imagery and the flight.

namespace pilotage {

/// What the level loses for each factor e of that time, in logits, and how much that differs from place to place
/// (standard deviation). **Reasoned from few places, not fitted**: docs/methods/matchability.md.
inline constexpr double kLevelPerAge = -0.4;
inline constexpr double kLevelPerAge_sigma = 0.4;
/// The time between the dates of the pairs that the level of the default model rests on, about: their geometric mean,
/// where those whose dates are not known are taken for a year apart.
inline constexpr double kAgeOfLevel_months = 24;
/// Nothing is known of less and of more; such imagery is taken to be so old.
inline constexpr double kLeastAge_months = 0.7;
inline constexpr double kMostAge_months = 170;

/// The default model for a flight so many months after its imagery, or before it: the mean of each level moves, and its
/// sigma grows by what is not known of that. Not for a model of one's own: its level is that of its own dates.
MatchabilityModel model_at_age(MatchabilityModel model, double age_months);

/// "0.4 ± 0.4 logits less for each factor e over 24 months": what the rule says.
std::string level_per_age_text();

}  // namespace pilotage
