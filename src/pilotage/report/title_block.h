#pragma once

#include <string>
#include <utility>
#include <vector>

#include "pilotage/report/report_input.h"

namespace pilotage {

/// What a sheet says of itself before it says anything else, as labels and values: when it was made (only where
/// SOURCE_DATE_EPOCH says so: the same input gives the same page), flight time, speed and height, camera, imagery with
/// its date, CRS. Speeds and heights are those of the route's samples; the time is the sum of length over speed.
std::vector<std::pair<std::string, std::string>> title_block(const ReportInput& input);

}  // namespace pilotage
