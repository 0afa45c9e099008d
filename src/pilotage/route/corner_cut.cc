#include "pilotage/route/corner_cut.h"

#include <algorithm>
#include <cmath>

#include "pilotage/base/angle.h"
#include "pilotage/base/text.h"
#include "pilotage/geo/geodesic.h"
#include "pilotage/route/route_builder.h"

namespace pilotage {

double corner_cut_m(GeodeticPoint before, GeodeticPoint corner, GeodeticPoint after, double turn_starts_m) {
  const GeodesicLeg in = geodesic_between(before, corner);
  const GeodesicLeg out = geodesic_between(corner, after);
  if (!(turn_starts_m > 0) || in.length_m < kSamePlace_m || out.length_m < kSamePlace_m) return 0;
  const double start_m = std::min({turn_starts_m, in.length_m, out.length_m});
  const double turn_rad = std::remainder(out.start_azimuth_deg - in.end_azimuth_deg, 360) * kRadPerDeg;
  return start_m * std::abs(std::sin(turn_rad / 2));
}

void add_corner_note(Route& route, double widest_m) {
  if (widest_m < kSamePlace_m) return;
  add_note(route,
           "The aircraft turns before its waypoints; the route has straight legs to each of them, which it leaves by " +
               format_fixed(widest_m, widest_m < 10 ? 1 : 0) + " m at most.");
}

}  // namespace pilotage
