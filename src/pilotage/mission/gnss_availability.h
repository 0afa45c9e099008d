#pragma once

#include <cstddef>
#include <vector>

#include "pilotage/mission/mission.h"

namespace pilotage {

/// Where the aircraft has GNSS along the samples of its route.
struct GnssAvailability {
  std::vector<bool> at_sample;  ///< GNSS holds the errors there (ins/ins_state.h); no match is needed.
  std::vector<bool> over_step;  ///< From each sample to the next, one fewer: all the way.
};

/// A sample is denied when it lies in a stretch [from, to), the route's last one also where a stretch ends; a step when
/// any of it lies in one. So GNSS is lost at the sample where a stretch begins or at the last one before, and is had
/// again at the first sample at or behind its end. A flight that may lose GNSS anywhere loses it here at its first
/// point.
GnssAvailability gnss_availability(const Flight& flight);

/// The same of a flight that loses GNSS at `distance_m` along the route for good.
GnssAvailability gnss_lost_at(const Flight& flight, double distance_m);

/// The same of a flight that has GNSS all the way, or nowhere.
GnssAvailability gnss_everywhere(const Flight& flight, bool had);

}  // namespace pilotage
