#pragma once

#include <vector>

#include "pilotage/geo/geodetic_point.h"

namespace pilotage {

/// Curves of missions as chords. They leave the curve by kChordError_m at most.
inline constexpr double kChordError_m = 0.5;

/// East and north components of a vector on the ground at a point.
struct GroundVector {
  double east_m = 0;
  double north_m = 0;
};

/// A point inside a curve, ends left out.
struct CurvePoint {
  GeodeticPoint point;
  double fraction = 0;  ///< Of the length of the curve.
};

/// The vector from one point to another, as the geodesic leaves the first one.
GroundVector ground_vector(GeodeticPoint from, GeodeticPoint to);
/// The same as the geodesic arrives at the second one.
GroundVector arriving_vector(GeodeticPoint from, GeodeticPoint to);

/// The cubic Hermite curve that ArduCopter flies to a spline waypoint (ArduPilot, libraries/AP_Math/SplineCurve: the
/// polynomial and its limit; libraries/AC_WPNav: the end vectors), with the end vectors `leaving` and `arriving`; both
/// are shortened by one factor when their lengths together exceed four times the distance. The plane is azimuthal
/// equidistant about `from`. Empty where the curve is straight to within kChordError_m. `*departure_m` becomes the
/// largest distance of the curve from the straight leg.
std::vector<CurvePoint> spline_points(GeodeticPoint from, GeodeticPoint to, GroundVector leaving, GroundVector arriving,
                                      double* departure_m);

/// Points of a circle, the first one on the azimuth `start_azimuth_deg` from the centre; the circle closes there.
std::vector<GeodeticPoint> circle_points(GeodeticPoint center, double radius_m, double start_azimuth_deg,
                                         bool clockwise);

}  // namespace pilotage
