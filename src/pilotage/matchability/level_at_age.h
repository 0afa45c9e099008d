#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pilotage/ground/tile_scores.h"
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

/// How the level of the default model moves when the imagery is `to_months` old and not `from_months`, of which its
/// sigma is `sigma`.
struct LevelMove {
  double mean_shift = 0;  ///< Logits, of every tile alike.
  double sigma = 0;
};
LevelMove move_level(double sigma, double from_months, double to_months);

/// Moves the P, level_sigma and level_age_months of a tile to another age; leaves one alone whose P counts none.
void move_to_age(TileScores& score, double age_months);

/// The age of the imagery that the P of tiles counts: that of those with `counts` and a P above 0 (ground without
/// features has no level). Nothing where the P of any of them counts none. Throws DataError when they count different
/// ages: they were scored for different days.
std::optional<double> counted_age_months(const std::vector<TileScores>& scores, const std::vector<bool>& counts);

/// The greatest age of the imagery at which P of a tile is one half or more, at least the age that it has now; nothing
/// where P is less now, says no age (TileScores::level_age_months), or counts kMostAge_months and more already.
/// kMostAge_months: as far as anything is known. At one half what is not known of the level does not count: so it is
/// the age that takes from the logit all it has.
std::optional<double> half_found_up_to_months(const TileScores& score);

/// Whether it still is, so many months later than now.
bool is_half_found_later(const TileScores& score, double later_months);

/// "0.4 ± 0.4 logits less for each factor e over 24 months": what the rule says.
std::string level_per_age_text();

}  // namespace pilotage
