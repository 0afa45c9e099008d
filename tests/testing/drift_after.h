#pragma once

#include "pilotage/ins/ins_error_model.h"
#include "pilotage/ins/ins_state.h"

namespace pilotage::testing {

/// The error state `time_s` seconds of straight flight at `speed_mps` after a position of error `position_sigma_m`,
/// with all else as at the loss of GNSS.
inline InsState drift_after(const InsErrorModel& model, double time_s, double speed_mps, double position_sigma_m) {
  InsErrorModel start = model;
  start.start_sigma_m = position_sigma_m;
  return propagate(initial_ins_state(start, 0, speed_mps), time_s, 0, speed_mps, model);
}

}  // namespace pilotage::testing
