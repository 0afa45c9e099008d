#include "pilotage/geo/local_frame.h"

#include <cmath>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/geo/ecef.h"

namespace pilotage {

LocalFrame::LocalFrame(GeodeticPoint origin, double height_m) : origin_(origin) {
  if (!std::isfinite(origin.lon_deg) || !std::isfinite(height_m) || !(std::abs(origin.lat_deg) <= 90.0)) {
    throw UsageError("local frame at lon " + format_number(origin.lon_deg) + ", lat " + format_number(origin.lat_deg) +
                     ", height " + format_number(height_m) + ": not a place on Earth");
  }
  origin_ecef_m_ = ecef_from_geodetic(origin, height_m);
  enu_from_ecef_ = enu_from_ecef(origin);
}

Eigen::Vector3d LocalFrame::enu_from_geodetic(GeodeticPoint point, double height_m) const {
  return enu_from_ecef_ * (ecef_from_geodetic(point, height_m) - origin_ecef_m_);
}

GeodeticPoint LocalFrame::geodetic_from_enu(const Eigen::Vector3d& enu_m) const {
  return geodetic_from_ecef(origin_ecef_m_ + enu_from_ecef_.transpose() * enu_m);
}

}  // namespace pilotage
