#pragma once

#include "pilotage/base/utc_time.h"
#include "pilotage/geo/geodetic_point.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// Where the sun stands, seen from the ground.
struct SunPosition {
  double azimuth_deg = 0;    ///< Clockwise from true north, 0 … 360.
  double elevation_deg = 0;  ///< Of its centre above the horizon, without refraction.
};

/// The sun's place over a point at a moment, to 0.02° from 1900 to 2100 (J. Meeus, Astronomical Algorithms, 2nd ed.
/// 1998: the sun's apparent place to low accuracy, chapter 25, and sidereal time, chapter 12). Left out are refraction,
/// which lifts a sun more than 5° high by less than 0.17°, the sun's parallax (0.0024°), and that the Earth's turn is
/// counted in UTC. `time` must be one that parse_utc_date gives. Domain: finite coordinates; the azimuth at a pole is
/// counted from the meridian of its longitude.
SunPosition sun_position(GeodeticPoint point, UtcTime time);

}  // namespace pilotage

#pragma GCC visibility pop
