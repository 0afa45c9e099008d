#pragma once

#include <string>
#include <vector>

#include "pilotage/mission/selection.h"
#include "pilotage/select/fix_attempts.h"
#include "pilotage/select/route_probability.h"

namespace pilotage {

struct AdviceOptions {
  FixTries tries;
  double min_leg_probability = 0.95;
  int threads = 1;
};

/// For each leg whose P to stay within the limit is below min_leg_probability: parallel lines to the left and to the
/// right, one tile stride further aside each time up to the corridor's half width, because only there tiles are scored.
/// The nearest one that makes the leg good, left before right; else the best, the nearest among equals. The line itself
/// is tried first, because `tile_chances` may hold more than was selected. The leg is entered with the flights of
/// `survival`, which must have kept them (entries_below); the way to the parallel line and back is not counted. Legs
/// that no flight reaches within the limit are left out.
std::vector<LegAdvice> advise_legs(const FlightPath& path, const RouteSurvival& survival,
                                   const TileChances& tile_chances, const AdviceOptions& options);

/// "leg 3: 0.62 of 0.95; flown 45 m to the left it has 0.97". Legs count from 1, as on the report's page.
std::string advice_text(const LegAdvice& advice, double min_leg_probability, double half_width_m);

}  // namespace pilotage
