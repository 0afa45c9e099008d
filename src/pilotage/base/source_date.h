#pragma once

#include <optional>

#include "pilotage/base/utc_time.h"

namespace pilotage {

/// The moment that the environment variable SOURCE_DATE_EPOCH names in seconds since 1970
/// (https://reproducible-builds.org/specs/source-date-epoch), so that two runs write the same bytes; nothing when it is
/// not set. Throws UsageError when it is not a number of seconds from 0 to the end of the year 9999.
std::optional<UtcTime> source_date();

}  // namespace pilotage
