#include "pilotage/evaluate/tile_outcome.h"

namespace pilotage {

std::string_view outcome_name(Outcome outcome) {
  switch (outcome) {
    case Outcome::kCorrect:
      return "correct";
    case Outcome::kFalse:
      return "false";
    case Outcome::kRefused:
      return "refused";
    case Outcome::kNotCovered:
      break;
  }
  return "not_covered";
}

}  // namespace pilotage
