#pragma once

#include <cstddef>
#include <optional>

#include "pilotage/mission/mission.h"

namespace pilotage {

/// The tile of a mission that a frame over a point of the route is compared with: the one of the sample's level whose
/// centre is nearest, which is within half a stride in both axes. Index into mission.ground.tiles; nothing when the
/// sample has no level or the ground has no tile there.
std::optional<std::size_t> tile_under(const Mission& mission, const FlightSample& sample);

}  // namespace pilotage
