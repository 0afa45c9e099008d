#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "pilotage/mission/mission.h"
#include "pilotage/replay/replayed_frame.h"

namespace pilotage {

/// Where a frame was taken beside the planned line.
struct LinePlace {
  std::size_t sample = 0;  ///< Of the plan's flight, the nearest that is flown in this direction.
  int leg = 0;
  double offset_m = 0;                                                  ///< Distance from it.
  double height_error_m = std::numeric_limits<double>::quiet_NaN();     ///< Flown minus planned height above ground.
  double heading_error_deg = std::numeric_limits<double>::quiet_NaN();  ///< Track minus planned, −180 … 180.
  double speed_mps = std::numeric_limits<double>::quiet_NaN();          ///< Over ground, flown.
  double planned_speed_mps = std::numeric_limits<double>::quiet_NaN();
  bool beyond_corridor = false;
  bool beyond_heights = false;  ///< No level of the map serves the height.
};

/// The way between a frame and its neighbours in time; NaN where they are not 0.2 to 60 s apart.
struct FlownTrack {
  double track_deg = std::numeric_limits<double>::quiet_NaN();
  double speed_mps = std::numeric_limits<double>::quiet_NaN();
};
std::vector<FlownTrack> flown_track(const ReplayedFlight& flight);

/// For each frame of a flight its place on the planned line: among the samples whose direction is within 60° of the
/// track, where this is known, the nearest. Nothing for a frame without a place, and for one farther from the line than
/// kOffTheLine_m and three half widths of the corridor.
std::vector<std::optional<LinePlace>> places_on_line(const ReplayedFlight& flight, const Mission& mission);

inline constexpr double kOffTheLine_m = 500;

}  // namespace pilotage
