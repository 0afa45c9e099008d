#include "pilotage/evaluate/tile_outcome.h"

namespace pilotage {

std::string_view outcome_name(Outcome outcome) {
  switch (outcome) {
    case Outcome::kCorrect:
      return "correct";
    case Outcome::kFalse:
      return "false";
    case Outcome::kUnjudged:
      return "unjudged";
    case Outcome::kRefused:
      return "refused";
    case Outcome::kNotTried:
      break;
  }
  return "not_covered";
}

bool is_accepted(const TileOutcome& outcome) {
  return outcome.outcome == Outcome::kCorrect || outcome.outcome == Outcome::kFalse;
}

void set_outcome_errors(TileOutcome& outcome, const Fix& best, const std::optional<GeodeticPoint>& true_center,
                        const std::optional<GeodeticPoint>& true_nadir) {
  std::optional<FixError> judged;
  if (true_nadir) {
    judged = error_of_fix(best, *true_nadir, FrameTruth::kNadir);
    outcome.nadir_error_m = judged->error_m;
  }
  if (true_center) judged = error_of_fix(best, *true_center, FrameTruth::kCenter);
  if (!judged) return;
  outcome.error_m = judged->error_m;
  outcome.error_east_m = judged->east_m;
  outcome.error_north_m = judged->north_m;
}

}  // namespace pilotage
