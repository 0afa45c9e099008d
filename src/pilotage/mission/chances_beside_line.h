#pragma once

#include <array>
#include <vector>

#include "pilotage/mission/mission.h"

namespace pilotage {

/// What P is where the aircraft is not on its line, as a share of P on it: of tries by aircraft that are off by a
/// normal error of each axis, at three sizes of it. Along the line the same tile may be below; beside it are others, or
/// none.
struct ChancesBesideLine {
  double step_m = 0;                         ///< Stride of the tiles. 0: nothing is known, the share is 1.
  std::array<double, 3> shares = {1, 1, 1};  ///< At σ = step / 4, step / 2, step.

  /// Straight between those, 1 without an error, and beyond the last as there.
  double share_at(double sigma_m) const;
};

/// At a sample of the route by the tile below and those around it, with 40 errors that stand for the distribution.
ChancesBesideLine chances_beside_line(const Mission& mission, const FlightSample& on_line,
                                      const std::vector<double>& p_of_tile);

}  // namespace pilotage
