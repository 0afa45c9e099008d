#pragma once

#pragma GCC visibility push(default)

namespace pilotage {

/// A point on the WGS 84 ellipsoid. lat_deg in [-90, 90]; lon_deg in [-180, 180] unless a function says otherwise.
struct GeodeticPoint {
  double lon_deg = 0;
  double lat_deg = 0;
};

/// Brings a longitude into [-180, 180).
double wrap_lon_deg(double lon_deg);

/// The longitude equal to `lon_deg` modulo 360 that lies within 180 degrees of `reference_deg`, so that a line across
/// the antimeridian has no jump.
double unwrap_lon_deg(double lon_deg, double reference_deg);

}  // namespace pilotage

#pragma GCC visibility pop
