#pragma once

#include <optional>

#include "rasterise.h"
#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pilotage/base/random.h"
#include "pilotage/geo/geodetic_point.h"
#include "pilotage/ins/ins_error_model.h"
#include "pilotage/navigate/navigation_filter.h"
#include "pilotage/navigate/strapdown.h"

namespace pilotage {

/// Where something is on the field, east, north, up in metres from its middle.
struct FieldState {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();
  Eigen::Matrix3d enu_from_body = Eigen::Matrix3d::Identity();
};

/// The figures of the altimeter, a laser over flat ground.
inline constexpr double kAltimeterSlow_m = 0.03;
inline constexpr double kAltimeterNoise_m = 0.03;

/// A multirotor that flies by what its navigation believes. The truth is a mechanisation of what an ideal IMU counts,
/// which the drawn errors of the inertial grade are added to for the navigation filter (src/pilotage/navigate). The
/// autopilot is ideal but for the navigation: thrust and attitude are what is asked for, against the believed
/// attitude. A copy flies on by itself, with the same draws.
class Aircraft {
 public:
  /// Hangs at `start`, nose along `heading_deg`; the filter starts as wrong as `model` says, all drawn from `seed`.
  Aircraft(GeodeticPoint middle, const InsErrorModel& model, double map_sigma_m, const Eigen::Vector3d& start,
           double heading_deg, std::uint64_t seed);

  static constexpr double kStep_s = 0.02;

  /// One step: the velocity that is wanted and where the nose is to point.
  void fly(const Eigen::Vector3d& velocity_mps, double heading_deg);

  double time_s() const { return truth_.time_s; }
  FieldState truth() const { return on_field(truth_); }
  FieldState believed() const { return on_field(filter_.state()); }
  /// Of the believed state's errors: position (m), turn (rad), east, north, up.
  Eigen::Matrix<double, 6, 6> pose_covariance();
  NavigationFilter& filter() { return filter_; }

 private:
  FieldState on_field(const InertialState& state) const;
  ImuIncrement measured(const ImuIncrement& counted);

  GeodeticPoint middle_;
  Eigen::Matrix3d enu_from_ecef_;
  Eigen::Vector3d origin_m_;
  InsErrorModel model_;
  Random random_;
  Eigen::Vector3d gyro_bias_radps_;
  Eigen::Vector3d accel_bias_mps2_;
  Eigen::Vector3d gyro_scale_;
  Eigen::Vector3d accel_scale_;
  double altimeter_m_ = 0;
  InertialState truth_;
  ImuIncrement before_;
  NavigationFilter filter_;
  Eigen::Vector3d wanted_mps2_ = Eigen::Vector3d::Zero();
  double heading_deg_ = 0;
  int steps_ = 0;
};

}  // namespace pilotage
