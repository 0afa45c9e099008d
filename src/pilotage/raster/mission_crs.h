#pragma once

#include <string>
#include <vector>

#include "pilotage/geo/geodetic_point.h"
#include "pilotage/raster/gdal_crs.h"

namespace pilotage {

/// Above this a mission grid is refused: over a footprint of 150 m, 0.5 % is 0.75 m, more than a pixel.
inline constexpr double kMaxScaleDistortion = 0.005;
/// Up to this the standard UTM or UPS zone is kept, because planners recognise it.
inline constexpr double kStandardZoneDistortion = 0.001;

struct MissionCrs {
  Crs crs;
  double max_scale_distortion = 0;  ///< Largest |scale − 1| over the corridor, both directions, edges included.
  std::string reason;               ///< Why this one, as a sentence for the planner.
};

/// Points that stand for a corridor: its centre line along geodesics between consecutive `route` points and both its
/// edges, `half_width_m` aside, at most 1/200 of the length (and never less than 100 m) apart.
std::vector<GeodeticPoint> corridor_points(const std::vector<GeodeticPoint>& route, double half_width_m);

/// Largest |scale − 1| of `crs` over the points: the singular values of the map's Jacobian, which is taken numerically
/// from grid distances of 100 m geodesics northwards and eastwards; error below 1e-7. Infinite where a point has no
/// image.
double scale_distortion(const Crs& crs, const std::vector<GeodeticPoint>& points);

/// The CRS of the mission grid for a corridor: the UTM zone (UPS beyond 84° N and 80° S) of its middle while its
/// distortion is at most kStandardZoneDistortion, else the least distorted of: that zone, a transverse Mercator on
/// the mean meridian, an oblique Mercator along the best great circle, a Lambert conformal conic (Mercator at the
/// equator) on the mean parallel, the last three with the scale factor that balances the distortion. Works across the
/// antimeridian and the poles. `route` is followed along geodesics. Throws UsageError for an empty or not finite route,
/// DataError when no candidate stays below kMaxScaleDistortion.
MissionCrs choose_mission_crs(const std::vector<GeodeticPoint>& route, double half_width_m);

/// The CRS a user asked for, held to the same standard. Throws UsageError when it is not projected, not in metres or
/// distorts more than kMaxScaleDistortion over the corridor.
MissionCrs check_mission_crs(const Crs& crs, const std::vector<GeodeticPoint>& route, double half_width_m);

}  // namespace pilotage
