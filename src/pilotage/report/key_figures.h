#pragma once

#include <string>
#include <vector>

#include "pilotage/verdict/quality.h"

namespace pilotage {

struct Report;

/// A number that the first look is for, and what belongs to it.
struct KeyFigure {
  std::string label;
  std::string value;
  std::string detail;
  NumberKind kind = NumberKind::kStated;
};

/// In the order of the question: how likely the flight stays within its limit, by the model, by simulated flights and
/// by flown ones; the longest gap; the largest error; how much of the route can be matched; how large the map is. What
/// is not known is left out, but for simulated flights, which are said to be missing.
std::vector<KeyFigure> key_figures(const Report& report);

}  // namespace pilotage
