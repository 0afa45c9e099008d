#include "pilotage/matchability/level_at_age.h"

#include <algorithm>
#include <cmath>

#include "pilotage/base/text.h"

namespace pilotage {

MatchabilityModel model_at_age(MatchabilityModel model, double age_months) {
  const double factors = std::log(std::clamp(age_months, kLeastAge_months, kMostAge_months) / kAgeOfLevel_months);
  for (MatcherModel& matcher : model.matchers) {
    PlaceLevel& level = matcher.level;
    level.mean += kLevelPerAge * factors;
    level.sigma = std::hypot(level.sigma, kLevelPerAge_sigma * factors);
  }
  return model;
}

std::string level_per_age_text() {
  return format_fixed(-kLevelPerAge, 1) + " ± " + format_fixed(kLevelPerAge_sigma, 1) +
         " logits less for each factor e over " + format_fixed(kAgeOfLevel_months, 0) + " months";
}

}  // namespace pilotage
