#pragma once

#include <filesystem>

#include "pilotage/base/utc_time.h"

namespace pilotage {

/// Share of the time, 0 … 1, at which cloud or fog hides the ground from the flight's height, by a table (CSV) with the
/// columns `month` (1 to 12), `hidden_fraction` (0 to 1) and, where it counts by hour, `hour_utc` (0 to 23); others are
/// skipped. A table by hour is asked at the hour of `flight`, or, for a day alone, for the mean of the hours it has.
///
/// Throws DataError when the file cannot be read or is no such table, a value is outside its range, a month (and hour)
/// comes twice, or the flight's is missing.
double hidden_fraction(const std::filesystem::path& file, const UtcDate& flight);

}  // namespace pilotage
