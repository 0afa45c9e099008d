#pragma once

#include <cmath>
#include <string>

#include "pilotage/ins/ins_options.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// The figures of InsOptions in SI units, grade resolved. Each is one standard deviation of one axis.
struct InsErrorModel {
  double accel_bias_mps2 = 0;
  double gyro_bias_radps = 0;
  double velocity_random_walk_mps_rt_s = 0;  ///< √ of the spectral density: σ of velocity after 1 s.
  double angle_random_walk_rad_rt_s = 0;     ///< σ of an angle after 1 s.
  double accel_scale = 0;                    ///< Fraction of the acceleration in manoeuvres.
  double gyro_scale = 0;                     ///< Fraction of the angle turned.
  double bias_correlation_s = 0;             ///< 0: constant biases.
  double start_velocity_sigma_mps = 0;
  double start_tilt_sigma_rad = 0;
  double start_heading_sigma_rad = 0;
  double odometry_drift = 0;          ///< Radial rms error per distance flown; above 0 the model is visual odometry.
  double velocity_aid_sigma_mps = 0;  ///< 0: no aiding velocity.
  double velocity_aid_correlation_s = 300;
  double start_sigma_m = 3;
  double fix_sigma_m = 2;  ///< Beside the map's.
  double sigma_multiple = 3;
  double map_sigma_m = 0;          ///< Of the map's georeference.
  double map_correlation_m = 300;  ///< Way over which it changes.

  bool is_odometry() const { return odometry_drift > 0; }
  /// Of the position after the first fix by a map.
  double fixed_position_sigma_m() const { return std::hypot(fix_sigma_m, map_sigma_m); }
};

/// Noise of an aiding velocity beside its slow error: σ of the mean over 1 s.
inline constexpr double kVelocityAidNoise_mps_rt_hz = 0.1;

/// Grade or product, and given figures, to one model. Throws UsageError when a figure is outside its range, when grade
/// `custom` comes with no figure that makes an error grow, when both a grade and a product are named, and as
/// ins_product.
InsErrorModel make_ins_error_model(const InsOptions& options);

}  // namespace pilotage

#pragma GCC visibility pop
