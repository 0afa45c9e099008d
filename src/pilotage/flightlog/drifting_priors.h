#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "pilotage/ins/ins_error_model.h"

namespace pilotage {

/// Where an aircraft is at a time, as far as its inertial system is concerned.
struct FlownPlace {
  double time_s = 0;
  double heading_deg = 0;
};

/// The error of an inertial position, and the covariance that the system's error model gives it.
struct DriftingPrior {
  Eigen::Vector2d error_en_m{0, 0};
  Eigen::Matrix2d covariance_en_m2 = Eigen::Matrix2d::Zero();
};

/// One draw of an inertial system's errors, from the loss of GNSS at the first of `places`, flown at one speed: the
/// equations of docs/methods/ins.md integrated step by step, with turns at the places. Throws UsageError for models
/// with an aiding velocity or of visual odometry, and for places that go back in time.
std::vector<DriftingPrior> drifting_priors(const std::vector<FlownPlace>& places, double speed_mps,
                                           const InsErrorModel& model, std::uint64_t seed);

}  // namespace pilotage
