#include "pilotage/geo/enu_from_grid.h"

#include <Eigen/LU>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/geo/local_frame.h"

namespace pilotage {

Eigen::Matrix2d enu_from_grid(
    const Eigen::Vector2d& center_m, double step_m,
    const std::function<std::optional<GeodeticPoint>(const Eigen::Vector2d& point_m)>& geodetic_from_map) {
  const auto geodetic = [&](const Eigen::Vector2d& point_m) {
    const std::optional<GeodeticPoint> point = geodetic_from_map(point_m);
    if (point) return *point;
    throw DataError("grid point (" + format_number(point_m.x()) + ", " + format_number(point_m.y()) +
                    ") has no longitude and latitude in the grid's CRS");
  };
  const LocalFrame frame(geodetic(center_m));
  Eigen::Matrix2d result;
  for (int axis = 0; axis < 2; ++axis) {
    const Eigen::Vector2d step = step_m * Eigen::Vector2d::Unit(axis);
    const Eigen::Vector3d ahead = frame.enu_from_geodetic(geodetic(center_m + step));
    const Eigen::Vector3d behind = frame.enu_from_geodetic(geodetic(center_m - step));
    result.col(axis) = (ahead - behind).head<2>() / (2 * step_m);
  }
  if (!result.allFinite() || !(result.determinant() > 0)) {
    throw DataError("the grid's CRS cannot be inverted at (" + format_number(center_m.x()) + ", " +
                    format_number(center_m.y()) + ")");
  }
  return result;
}

}  // namespace pilotage
