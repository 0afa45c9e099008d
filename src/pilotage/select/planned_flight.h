#pragma once

#include <vector>

#include "pilotage/mission/gnss_availability.h"
#include "pilotage/mission/mission.h"
#include "pilotage/mission/selection.h"

namespace pilotage {

/// Which tiles of the ground a selection stores. Throws DataError when one is not of the mission.
std::vector<bool> stored_tiles(const Mission& mission, const Selection& selection);

/// GNSS along the flight that a selection predicts: the plan's, lost at the worst point where it may be lost anywhere.
GnssAvailability planned_gnss(const Mission& mission, const Selection& selection);

}  // namespace pilotage
