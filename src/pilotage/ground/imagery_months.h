#pragma once

#include <optional>

#include "pilotage/base/utc_time.h"
#include "pilotage/ground/ground.h"

namespace pilotage {

/// Months of 1/12 year from one moment to another; negative when `to` is the earlier.
double months_between(UtcTime from, UtcTime to);

/// Months between the ground's imagery and the flight over it, of the raster that is farthest from it, whichever is
/// first. Nothing when the time of the flight or the date of any raster is not known.
std::optional<double> imagery_months(const Ground& ground);

}  // namespace pilotage
