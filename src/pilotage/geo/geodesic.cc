#include "pilotage/geo/geodesic.h"

#include <GeographicLib/Geodesic.hpp>

namespace pilotage {

GeodesicLeg geodesic_between(GeodeticPoint from, GeodeticPoint to) {
  GeodesicLeg leg;
  GeographicLib::Geodesic::WGS84().Inverse(from.lat_deg, from.lon_deg, to.lat_deg, to.lon_deg, leg.length_m,
                                           leg.start_azimuth_deg, leg.end_azimuth_deg);
  return leg;
}

GeodeticPoint geodesic_direct(GeodeticPoint from, double azimuth_deg, double distance_m) {
  GeodeticPoint to;
  GeographicLib::Geodesic::WGS84().Direct(from.lat_deg, from.lon_deg, azimuth_deg, distance_m, to.lat_deg, to.lon_deg);
  return to;
}

}  // namespace pilotage
