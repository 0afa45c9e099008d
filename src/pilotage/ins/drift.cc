#include "pilotage/ins/drift.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

void require_positive(const char* what, double value) {
  if (!(value > 0) || !std::isfinite(value)) {
    throw UsageError(std::string(what) + " = " + format_number(value) + " is not a positive number");
  }
}

InsState state_after_position(const InsErrorModel& model, double speed_mps, double position_sigma_m) {
  InsErrorModel start = model;
  start.start_sigma_m = position_sigma_m;
  return initial_ins_state(start, 0, speed_mps);
}

}  // namespace

double longest_bridgeable_gap_s(const InsErrorModel& model, double speed_mps, double max_error_m, double sigma_multiple,
                                double fix_sigma_m) {
  require_positive("speed_mps", speed_mps);
  require_positive("max_error_m", max_error_m);
  require_positive("sigma_multiple", sigma_multiple);
  require_positive("fix_sigma_m", fix_sigma_m);
  constexpr double kResolution_s = 1e-3;
  InsState inside = state_after_position(model, speed_mps, fix_sigma_m);
  if (position_error_m(inside, sigma_multiple) > max_error_m) return 0;
  // Walk forward, because the Schuler oscillation makes the error fall again after a while and only the first crossing
  // counts; then narrow down the step that crosses.
  double step_s = 1;
  while (inside.time_s < kLongestGap_s) {
    const double dt_s = std::min(step_s, kLongestGap_s - inside.time_s);
    const InsState next = propagate(inside, dt_s, 0, speed_mps, model);
    if (position_error_m(next, sigma_multiple) <= max_error_m) {
      inside = next;
      step_s = std::min(step_s * 1.25, 60.0);
    } else if (dt_s > kResolution_s) {
      step_s = dt_s / 2;
      if (step_s < kResolution_s) return inside.time_s;
    } else {
      return inside.time_s;
    }
  }
  return kLongestGap_s;
}

double search_radius_m(double position_error_m, double half_footprint_m, double agl_m, double tilt_error_rad) {
  const double values[] = {position_error_m, half_footprint_m, agl_m, tilt_error_rad};
  for (const double value : values) {
    if (!(value >= 0)) throw UsageError("search_radius_m: " + format_number(value) + " is not 0 or more");
  }
  if (tilt_error_rad >= std::numbers::pi / 2) return std::numeric_limits<double>::infinity();
  return position_error_m + half_footprint_m + agl_m * std::tan(tilt_error_rad);
}

}  // namespace pilotage
