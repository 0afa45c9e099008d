#include "pilotage/report/number_kind.h"

namespace pilotage {

std::string kind_mark(NumberKind kind) {
  const auto mark = [](const std::string& word, const std::string& title) {
    return "<span class=\"kind " + word + "\" title=\"" + title + "\">" + word + "</span>";
  };
  switch (kind) {
    case NumberKind::kMeasured:
      return mark("measured", "Measured on the imagery or on flights");
    case NumberKind::kSimulated:
      return mark("simulated", "Counted over computed flights or frames with drawn errors");
    case NumberKind::kModelled:
      return mark("modelled", "Computed by a formula: the inertial error model, or a fitted P");
    case NumberKind::kStated:
      break;
  }
  return "";
}

}  // namespace pilotage
