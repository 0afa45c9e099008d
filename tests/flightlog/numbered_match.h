#pragma once

#include "pilotage/flightlog/frame_match.h"

namespace pilotage::testing {

/// A fix whose every number is another one.
inline Fix numbered_fix() {
  Fix fix;
  fix.position = {16.1, 55.2};
  fix.covariance_en_m2 << 4, 1.5, 1.5, 9;
  fix.center = {16.3, 55.4};
  fix.center_covariance_en_m2 << 16, -2.5, -2.5, 25;
  fix.yaw_deg = 151.5;
  fix.pitch_deg = 1.25;
  fix.roll_deg = -0.75;
  fix.yaw_sigma_deg = 0.5;
  fix.height_agl_m = 118.5;
  fix.height_sigma_m = 1.75;
  fix.scale = 0.9875;
  fix.tile_id = 4711;
  fix.map_sigma_m = 1.125;
  return fix;
}

/// An accepted frame with truth, likewise.
inline FrameMatch numbered_match() {
  FrameMatch match;
  match.frame.file = "a, b.jpg";
  match.frame.time_s = 12.5;
  match.frame.true_nadir = {16, 55};
  match.result.status = MatchStatus::kFix;
  match.result.fix = numbered_fix();
  match.result.candidate = match.result.fix;
  match.result.stats = {1,    0.55, 1500, 8000, 128.5, 640,  33.5, 7.25, 210, 0.65,
                        0.85, 0.45, 320,  4.5,  0.999, 77.5, 5,    4,    3};
  match.result.map_index = 2;
  match.result.map_statuses = {MatchStatus::kNoMap, MatchStatus::kAmbiguous, MatchStatus::kFix};
  match.confirmed = true;
  match.milliseconds = 21.5;
  match.error = FixError{1, -2, 2.25, 3.5};
  match.center_error = FixError{0.25, 0, 0.25, 1.75};
  match.candidate_error = match.error;
  match.candidate_center_error = match.center_error;
  return match;
}

}  // namespace pilotage::testing
