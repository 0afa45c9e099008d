#include "pilotage/verdict/map_holds.h"

#include <cmath>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/base/wording.h"
#include "pilotage/ground/imagery_months.h"
#include "pilotage/matchability/level_at_age.h"

namespace pilotage {
namespace {

constexpr double kHoldsGood_months = 6;

bool is_enough(const RouteProbability& route) {
  return route.p_within_limit >= route.min_p_within_limit;
}

/// "until about 2027-03, when the imagery is 21 months old"
std::string until_text(const Mission& mission, double up_to_months) {
  if (up_to_months >= kMostAge_months) {
    return "as far as anything is known, to imagery " + months_text(kMostAge_months) + " old";
  }
  return "until about " + month_of(day_at_age(dated_imagery(mission.ground), up_to_months)) + ", when the imagery is " +
         months_text(up_to_months) + " old";
}

std::string enough_text(const Mission& mission, const RouteProbability& route, const RouteAgeing& ageing) {
  const std::string asked_for = " what was asked for (" + probability_text(route.min_p_within_limit) + ")";
  const auto& up_to_months = ageing.enough_up_to_months;
  if (is_enough(route)) return "P is at least" + asked_for + " " + until_text(mission, up_to_months.value_or(0));
  if (!up_to_months) return "P is below" + asked_for + " with the stored tiles, however young the imagery";
  const double tenths = std::floor(*up_to_months * 10) / 10;
  const std::string age = *up_to_months < 1   ? "3 weeks"
                          : *up_to_months < 6 ? format_fixed(tenths, 1) + " months"
                                              : months_text(std::floor(*up_to_months));
  return "P is below" + asked_for + " on the planned day; with imagery no older than " + age +
         " the stored tiles would be enough";
}

std::string surely_text(const Mission& mission, const RouteProbability& route, const RouteAgeing& ageing) {
  if (!is_enough(route)) return "";
  const auto& up_to_months = ageing.surely_up_to_months;
  return "; the lower end of its interval " +
         (up_to_months ? until_text(mission, *up_to_months) : "is below it already");
}

}  // namespace

std::string day_at_age(UtcTime oldest, double age_months) {
  return format_utc_time(months_after(oldest, age_months)).substr(0, 10);
}

UtcTime dated_imagery(const Ground& ground) {
  const auto oldest = oldest_imagery(ground);
  if (!oldest) throw DataError("the selection counts the age of imagery, and the plan does not know all its dates");
  return *oldest;
}

std::string month_of(const std::string& day) {
  return day.substr(0, 7);
}

std::string half_found_until(std::optional<UtcTime> oldest, const TileScores& score) {
  const auto up_to_months = oldest ? half_found_up_to_months(score) : std::nullopt;
  return up_to_months ? day_at_age(*oldest, *up_to_months) : "";
}

std::string ageing_sentence(const Mission& mission, const Selection& selection) {
  if (!selection.ageing || !selection.probability) return "";
  return enough_text(mission, *selection.probability, *selection.ageing) +
         surely_text(mission, *selection.probability, *selection.ageing) + "; " + kAgeRule;
}

std::optional<QualityRow> ageing_row(const Mission& mission, const Selection& selection) {
  if (!selection.ageing || !selection.probability) return std::nullopt;
  const auto& up_to_months = selection.ageing->enough_up_to_months;
  QualityRow row;
  row.name = "map_holds";
  row.label = "How long the map holds";
  row.kind = NumberKind::kModelled;
  row.unit = "months";
  const bool enough = is_enough(*selection.probability);
  if (enough && up_to_months) row.number = *up_to_months - selection.ageing->ages.front().age_months;
  row.value = enough_text(mission, *selection.probability, *selection.ageing);
  row.threshold = "good from " + months_text(kHoldsGood_months) + " after the flight on; " + kAgeRule;
  const bool has_no_known_end = enough && up_to_months && *up_to_months >= kMostAge_months;
  if (has_no_known_end || row.number >= kHoldsGood_months) return row;
  row.status = QualityStatus::kMarginal;
  if (enough) {
    row.advice = "Have younger imagery for the flights after that, and prepare again.";
  } else {
    row.advice = up_to_months ? "Have younger imagery, and prepare again."
                              : "It is not the age of the imagery alone: see what speaks against the weakest places.";
  }
  return row;
}

}  // namespace pilotage
