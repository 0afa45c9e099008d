#pragma once

#include <optional>
#include <string>

#include "pilotage/verdict/quality.h"

namespace pilotage {

/// How far the georeference of a second date lies from the imagery's over the selected tiles, and what it does to the
/// error; nothing without a second date. Where the imagery is off by as much, every fix is, too.
struct GeoreferenceDisagreement {
  double median_m = 0;
  double largest_m = 0;
  double budget_m = 0;         ///< k·σ of a fix: what the prediction counts on.
  double largest_error_m = 0;  ///< Largest predicted error, and the disagreement on top.
};
std::optional<GeoreferenceDisagreement> georeference_disagreement(const JudgedPlan& plan);

/// A sentence for the planner where the disagreement is beyond the budget; else "".
std::string disagreement_warning(const JudgedPlan& plan);

/// The line of the quality table. It decides: marginal beyond the budget, bad where the largest error with the
/// disagreement on top is beyond the limit.
QualityRow disagreement_row(const GeoreferenceDisagreement& found, const Selection& selection);

}  // namespace pilotage
