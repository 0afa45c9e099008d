#include "pilotage/tile/working_gsd.h"

#include <algorithm>
#include <cmath>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/camera/projection.h"

namespace pilotage {
namespace {

constexpr double kFinest_m = 0.5;
constexpr double kCoarsest_m = 1.0;
constexpr double kFootprint_px = 256;
constexpr double kRounding_m = 0.01;
constexpr double kImageryTolerance = 0.01;  // ground GSD varies over a raster by its scale distortion

}  // namespace

double footprint_side_m(const Camera& camera, double agl_m) {
  const Footprint shape = footprint(camera, Attitude{}, agl_m);
  if (shape.polygon_m.empty()) {
    throw DataError("the camera sees no ground from " + format_number(agl_m) + " m in level flight; look at its mount");
  }
  return std::sqrt(shape.area_m2);
}

WorkingGsd choose_working_gsd(std::optional<double> wanted_gsd_m, double imagery_gsd_m, double camera_gsd_m,
                              double footprint_side_m) {
  if (wanted_gsd_m) {
    if (*wanted_gsd_m < imagery_gsd_m * (1 - kImageryTolerance)) {
      throw UsageError("gsd_m = " + format_number(*wanted_gsd_m) + " is finer than the imagery, which has " +
                       format_fixed(imagery_gsd_m, 3) + " m/px");
    }
    return {*wanted_gsd_m, "as asked for"};
  }
  const double footprint_gsd_m = std::ceil(footprint_side_m / kFootprint_px / kRounding_m - 1e-9) * kRounding_m;
  WorkingGsd result{std::clamp(footprint_gsd_m, kFinest_m, kCoarsest_m),
                    "where frames match best across dates and sensors (0.5 to 1 m/px)"};
  if (camera_gsd_m > result.gsd_m) result = {camera_gsd_m, "what the camera resolves at this height"};
  if (imagery_gsd_m > result.gsd_m) result = {imagery_gsd_m, "the imagery's own"};
  return result;
}

}  // namespace pilotage
