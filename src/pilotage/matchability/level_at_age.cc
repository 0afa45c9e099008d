#include "pilotage/matchability/level_at_age.h"

#include <algorithm>
#include <cmath>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/ground/place_level.h"

namespace pilotage {

namespace {

/// How many factors e an age is above that of the level; below it negative.
double factors_of(double age_months) {
  return std::log(std::clamp(age_months, kLeastAge_months, kMostAge_months) / kAgeOfLevel_months);
}

/// A table says both or none.
bool counts_age(const TileScores& score) {
  return !std::isnan(score.level_age_months) && !std::isnan(score.level_sigma);
}

}  // namespace

LevelMove move_level(double sigma, double from_months, double to_months) {
  const double from = kLevelPerAge_sigma * factors_of(from_months);
  const double to = kLevelPerAge_sigma * factors_of(to_months);
  return {kLevelPerAge * (factors_of(to_months) - factors_of(from_months)),
          std::sqrt(std::max(0.0, sigma * sigma - from * from + to * to))};
}

MatchabilityModel model_at_age(MatchabilityModel model, double age_months) {
  for (MatcherModel& matcher : model.matchers) {
    PlaceLevel& level = matcher.level;
    const LevelMove move = move_level(level.sigma, kAgeOfLevel_months, age_months);
    level.mean += move.mean_shift;
    level.sigma = move.sigma;
  }
  return model;
}

void move_to_age(TileScores& score, double age_months) {
  if (!counts_age(score)) return;
  const LevelMove move = move_level(score.level_sigma, score.level_age_months, age_months);
  const double logit = logit_of_p(score.p_correct_fix, score.level_sigma) + move.mean_shift;
  score.p_correct_fix = std::min(1.0, p_over_level(logit, move.sigma));
  score.level_sigma = move.sigma;
  score.level_age_months = age_months;
}

std::optional<double> counted_age_months(const std::vector<TileScores>& scores, const std::vector<bool>& counts) {
  std::optional<double> age_months;
  for (std::size_t i = 0; i < scores.size(); ++i) {
    if (!counts[i] || !(scores[i].p_correct_fix > 0)) continue;  // ground without features has no level
    const double of_tile = scores[i].level_age_months;
    if (!counts_age(scores[i])) return std::nullopt;
    if (age_months && *age_months != of_tile) {
      throw DataError("the scores count imagery " + format_number(*age_months) + " and " + format_number(of_tile) +
                      " months old; score all tiles for one flight");
    }
    age_months = of_tile;
  }
  return age_months;
}

std::optional<double> half_found_up_to_months(const TileScores& score) {
  const double p = score.p_correct_fix;
  if (!counts_age(score) || !(p >= 0.5) || score.level_age_months >= kMostAge_months) return std::nullopt;
  const double logit = logit_of_p(p, score.level_sigma);
  const double now_months = std::max(score.level_age_months, kLeastAge_months);
  return std::min(kMostAge_months, now_months * std::exp(-logit / kLevelPerAge));
}

bool is_half_found_later(const TileScores& score, double later_months) {
  const auto up_to_months = half_found_up_to_months(score);
  const double then_months = score.level_age_months + later_months;
  return up_to_months && *up_to_months >= std::min(then_months, kMostAge_months);
}

std::string level_per_age_text() {
  return format_fixed(-kLevelPerAge, 1) + " ± " + format_fixed(kLevelPerAge_sigma, 1) +
         " logits less for each factor e over " + format_fixed(kAgeOfLevel_months, 0) + " months";
}

}  // namespace pilotage
