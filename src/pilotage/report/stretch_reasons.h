#pragma once

#include <string>
#include <vector>

#include "pilotage/mission/selection.h"

namespace pilotage {

struct Report;

/// Why a stretch of the route is as it is, and what to change.
struct StretchReasons {
  std::string why;   ///< "Open water (9 of 14 tiles), hardly any contrast (4)."; "" when nothing is known.
  std::string todo;  ///< One sentence or two.
};

/// Of the stretch from_m to to_m along the route. Counts the reasons (ground/reason_code.h) of the tiles that are not
/// selected and whose nearest point of the route lies in it. `lost`: flights are lost though tiles are chosen; then it
/// says how soon the inertial system drifts beyond the limit and how surely a fix comes before. `report` has its legs,
/// gaps and tiles.
StretchReasons stretch_reasons(const Report& report, double from_m, double to_m, bool lost);

/// "Leg 5 flown 80 m to the left stays within the limit with P = 0.971 instead of 0.812." of the legs in the stretch;
/// "" where no advice is better.
std::string advice_text(const Report& report, const std::vector<LegAdvice>& advice, double from_m, double to_m);

/// "1.5 km – 2.2 km, legs 5 to 6"; `leg` (from 0) is where it starts.
std::string where_text(const Report& report, double from_m, double to_m, int leg);

}  // namespace pilotage
