#pragma once

#include <string>
#include <vector>

#include "pilotage/mission/mission.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// A point of the route with the ground under it.
struct HeightSample {
  double distance_m = 0;  ///< Along the route.
  double ground_m = 0;    ///< Above mean sea level; 0 where nothing tells it.
  double flown_m = 0;     ///< On the same scale.
};

/// Heights along a flight, thinned to at most 1,000 samples; of each stretch the least height above ground is kept.
struct HeightProfile {
  std::vector<HeightSample> samples;
  bool above_sea = false;  ///< Otherwise no sample tells the ground, and heights count from it.
  double min_agl_m = 0;    ///< Flight::min_agl_m.
};

/// Samples whose height above ground is not known are left out, and where some samples tell a height above sea level,
/// those that do not.
HeightProfile height_profile(const Flight& flight);

/// The drawing under the chart, along the same axis (`distance_m` at its right end); "" without a sample.
std::string height_profile_svg(const HeightProfile& profile, double distance_m);

}  // namespace pilotage

#pragma GCC visibility pop
