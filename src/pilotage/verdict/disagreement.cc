#include "pilotage/verdict/disagreement.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "pilotage/base/wording.h"

namespace pilotage {

std::optional<GeoreferenceDisagreement> georeference_disagreement(const JudgedPlan& plan) {
  const std::set<std::int64_t> selected(plan.selection.tile_ids.begin(), plan.selection.tile_ids.end());
  std::vector<double> apart_m;
  for (std::size_t i = 0; i < plan.scores.size(); ++i) {
    const double disagreement_m = plan.scores[i].epoch.disagreement_m;
    if (std::isfinite(disagreement_m) && selected.contains(plan.mission.ground.tiles[i].tile_id)) {
      apart_m.push_back(disagreement_m);
    }
  }
  if (apart_m.empty()) return std::nullopt;
  std::sort(apart_m.begin(), apart_m.end());
  GeoreferenceDisagreement found;
  found.median_m = apart_m[apart_m.size() / 2];
  found.largest_m = apart_m.back();
  found.budget_m = plan.selection.sigma_multiple * plan.mission.flight.ins.fix_sigma_m;
  found.largest_error_m = largest_error_m(plan.selection) + found.largest_m;
  return found;
}

std::string disagreement_warning(const JudgedPlan& plan) {
  const auto found = georeference_disagreement(plan);
  if (!found || found->largest_m <= found->budget_m) return "";
  return "the second date lies up to " + error_text(found->largest_m) + " (median " + error_text(found->median_m) +
         ") from the imagery where tiles are selected, more than the " + error_text(found->budget_m) +
         " that a fix may be off: one of the two is georeferenced wrongly, and every fix may be off by as much";
}

QualityRow disagreement_row(const GeoreferenceDisagreement& found, const Selection& selection) {
  QualityRow row;
  row.name = "georeference_disagreement";
  row.kind = NumberKind::kMeasured;
  row.label = "Second date: georeferences apart";
  row.number = found.largest_m;
  row.unit = "m";
  row.value = "up to " + error_text(found.largest_m) + ", median " + error_text(found.median_m) +
              "; largest error with it " + comparison_text(found.largest_error_m, selection.max_error_m);
  row.threshold = "good up to " + error_text(found.budget_m) +
                  " (what a fix may be off), marginal while the largest error with it stays within the limit";
  row.decides = true;
  if (found.largest_m <= found.budget_m) return row;
  row.status = found.largest_error_m <= selection.max_error_m ? QualityStatus::kMarginal : QualityStatus::kBad;
  row.advice =
      "One of the two dates lies wrong on the ground, and fixes are off by as much where it is this one: check both "
      "against surveyed points, and use the one that is right.";
  return row;
}

}  // namespace pilotage
