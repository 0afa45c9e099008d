#pragma once

#include <optional>

#include "pilotage/base/utc_time.h"
#include "pilotage/ground/ground.h"

namespace pilotage {

/// Months of 1/12 year from one moment to another; negative when `to` is the earlier.
double months_between(UtcTime from, UtcTime to);

/// The moment so many months after another.
UtcTime months_after(UtcTime time, double months);

/// The date of the oldest raster of the ground's imagery. Nothing when that of any is not known, or there is none.
std::optional<UtcTime> oldest_imagery(const Ground& ground);

/// Months between the ground's imagery and the flight over it, of the raster that is farthest from it, whichever is
/// first. Nothing when the time of the flight or the date of any raster is not known.
std::optional<double> imagery_months(const Ground& ground);

/// oldest_imagery() where later flights only get farther from the imagery: the oldest raster is the farthest from the
/// planned one, and before it. Nothing otherwise.
std::optional<UtcTime> ageing_imagery(const Ground& ground);

}  // namespace pilotage
