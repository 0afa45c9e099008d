#pragma once

#include <string>
#include <vector>

#include "pilotage/mission/autopilot.h"

namespace pilotage {

struct Report;
struct ReportInput;

bool is_px4(Autopilot autopilot);

/// Where the aircraft stays without a position by sight longer than its autopilot does without one, a sentence each;
/// empty where it does not. Only where GNSS is denied counts, or may be lost: from the end of matchable ground, or of
/// GNSS, to the first try on the next, or to GNSS. Times are the autopilots' (docs/methods/autopilots.md has the
/// sources). Of `report` the legs are read, of `input` the mission and the selection.
std::vector<std::string> autopilot_warnings(const ReportInput& input, const Report& report, Autopilot autopilot);

/// The parameters by which the autopilot takes positions by sight, with a comment for each, and autopilot_warnings():
/// a file for QGroundControl (PX4) or Mission Planner (ArduPilot).
std::string autopilot_parameters(const ReportInput& input, const Report& report, Autopilot autopilot);

}  // namespace pilotage
