#pragma once

#include <vector>

#include "pilotage/route/route.h"

namespace pilotage {

/// A leg of a track whose positions have times.
struct TrackStep {
  int vertex = 0;  ///< The one that the leg leads to.
  double length_m = 0;
  double passed_s = 0;  ///< From its start to its end; NaN where that is not known.
};

struct TrackTimes {
  std::vector<TrackStep> steps;
  double still_s = 0;  ///< Time spent at one place, which no leg holds.
  bool any = false;    ///< Does any position have a time?
};

/// Speeds are averaged over at least this long: positions may come several times in a second whose times are whole
/// seconds, and a metre of noise in one second would be a metre per second.
inline constexpr double kTrackAverage_s = 5;
/// Slower is standing still, faster is no aircraft of ours: the range of RouteOptions::speed_mps.
inline constexpr double kSlowest_mps = 0.1;
inline constexpr double kFastest_mps = 1000;

/// Sets RouteVertex::speed_mps of the vertices that the steps lead to: length over time of groups of steps that last
/// kTrackAverage_s or more together (a single longer step is a group of its own). Steps whose time is not known or runs
/// backwards end a group; they, and groups whose speed is outside the range above, take the mean of the others. What
/// was done stands in a note; without any speed in range the vertices keep none.
void set_track_speeds(Route& route, const TrackTimes& times);

}  // namespace pilotage
