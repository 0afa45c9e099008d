#pragma once

#include "pilotage/geo/geodetic_point.h"

namespace pilotage {

/// Geodesics of the WGS 84 ellipsoid through GeographicLib (C. F. F. Karney, "Algorithms for geodesics", J. Geodesy 87,
/// 2013; error below 15 nm). Azimuths in degrees clockwise from north.

struct GeodesicLeg {
  double length_m = 0;
  double start_azimuth_deg = 0;  ///< At the first point, in [-180, 180].
  double end_azimuth_deg = 0;    ///< Forward direction at the second point, in [-180, 180].
};

GeodesicLeg geodesic_between(GeodeticPoint from, GeodeticPoint to);

/// The point `distance_m` along the geodesic that leaves `from` at `azimuth_deg`; lon in [-180, 180].
GeodeticPoint geodesic_direct(GeodeticPoint from, double azimuth_deg, double distance_m);

}  // namespace pilotage
