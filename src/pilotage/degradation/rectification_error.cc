#include "pilotage/degradation/rectification_error.h"

#include <cmath>
#include <numbers>
#include <string>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"

namespace pilotage {

RectificationError rectification_error(const RectificationSigma& sigma) {
  const auto check = [](const char* name, double value, bool allowed, const char* what) {
    if (!allowed || !std::isfinite(value)) {
      throw UsageError(std::string(name) + " = " + format_number(value) + ": " + what);
    }
  };
  check("heading_sigma_deg", sigma.heading_sigma_deg, sigma.heading_sigma_deg >= 0, "must be 0 or more");
  check("tilt_sigma_deg", sigma.tilt_sigma_deg, sigma.tilt_sigma_deg >= 0, "must be 0 or more");
  check("height_sigma_m", sigma.height_sigma_m, sigma.height_sigma_m >= 0, "must be 0 or more");
  check("height_m", sigma.height_m, sigma.height_m > 0, "must be above 0");
  check("half_fov_deg", sigma.half_fov_deg, sigma.half_fov_deg > 0 && sigma.half_fov_deg <= 80,
        "must be above 0 and at most 80");
  const double degree = std::numbers::pi / 180;
  const double tangent = std::tan(sigma.half_fov_deg * degree);
  RectificationError error;
  error.rotation_deg = std::hypot(sigma.heading_sigma_deg, sigma.tilt_sigma_deg * tangent / std::sqrt(6.0));
  error.scale_percent =
      100 * std::hypot(sigma.height_sigma_m / sigma.height_m, sigma.tilt_sigma_deg * degree * tangent * std::sqrt(1.5));
  return error;
}

}  // namespace pilotage
