#pragma once

#include <Eigen/Core>

#include "pilotage/ins/ins_state.h"

namespace pilotage {

/// What fixes say of the error of an inertial position, and of the velocity, tilt and biases with which it drifts: the
/// inertial error model (ins/ins_state.h) with its expected errors, as a Kalman filter.
class DriftFilter {
 public:
  /// Before the first frame: the errors of the model's start hold when it is taken.
  DriftFilter(const InsErrorModel& model, double heading_deg, double speed_mps);

  /// Flies on. Throws UsageError as propagate().
  void fly_on(double dt_s, double heading_deg, double speed_mps);

  /// Takes this error of the inertial position for what is known of it, whatever the model makes of it.
  void start(const Eigen::Vector2d& error_m, const Eigen::Matrix2d& covariance_m2);

  /// Takes a measurement of the position's error.
  void update(const Eigen::Vector2d& measured_m, const Eigen::Matrix2d& covariance_m2);

  /// Inertial position minus truth, east and north.
  Eigen::Vector2d error_m() const { return estimate_.errors.head<2>(); }
  Eigen::Matrix2d covariance_m2() const { return estimate_.state.covariance.topLeftCorner<2, 2>(); }
  Eigen::Vector2d velocity_error_mps() const { return estimate_.errors.segment<2>(2); }

 private:
  InsErrorModel model_;
  InsEstimate estimate_;
};

}  // namespace pilotage
