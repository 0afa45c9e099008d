#pragma once

#include <string>
#include <vector>

#include "pilotage/mission/selection.h"
#include "pilotage/report/report_input.h"
#include "pilotage/verdict/quality.h"

#pragma GCC visibility push(default)

namespace pilotage {

struct Report;

/// A stretch of the route that a planner should look at first.
struct WeakPlace {
  double from_distance_m = 0;  ///< Along the route.
  double to_distance_m = 0;
  QualityStatus status = QualityStatus::kGood;
  std::string where;       ///< "1.5 km – 2.2 km, legs 5 to 6".
  std::string what;        ///< "752 m = 42 s without a fix; error at its end 37 m ≤ 60 m".
  std::string why;         ///< "Open water (9 of 14 tiles), hardly any contrast (4)."; "" when nothing is known.
  std::string todo;        ///< What to change, one sentence or two.
  bool most_lost = false;  ///< It is most_lost().
};

/// What page and chart call it.
inline constexpr const char* kMostLost = "most flights are lost here";

/// Where most flights are lost, if too few stay within the limit all the way; else null.
const WorstStretch* most_lost(const Report& report);

/// Where it cannot be flown, or first could not: the gaps, and the legs beyond 80 % of the limit that no gap explains.
/// Bad ones first, then by the probability of being lost there, then by the error; at most `most`. `report` has its
/// legs, gaps and tiles. "Why" counts the reasons (matchability/reasons.h) of the tiles that are not selected and whose
/// nearest point of the route lies in the place; where flights are lost though tiles are chosen, it says how soon the
/// inertial system drifts beyond the limit and how surely a fix comes before.
std::vector<WeakPlace> weak_places(const Report& report, const std::vector<LegAdvice>& advice, std::size_t most = 3);

}  // namespace pilotage

#pragma GCC visibility pop
