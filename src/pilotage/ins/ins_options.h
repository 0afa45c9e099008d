#pragma once

#include <optional>
#include <string>

#include "pilotage/base/options.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// Named classes of inertial sensors; docs/methods/ins.md has the table of figures and the datasheets they stand for.
enum class InsGrade { kConsumer, kIndustrial, kTactical, kNavigation, kVisualOdometry, kCustom };
inline EnumNames<InsGrade> enum_names(InsGrade) {
  return {{InsGrade::kConsumer, "consumer"},
          {InsGrade::kIndustrial, "industrial"},
          {InsGrade::kTactical, "tactical"},
          {InsGrade::kNavigation, "navigation"},
          {InsGrade::kVisualOdometry, "visual-odometry"},
          {InsGrade::kCustom, "custom"}};
}

/// What is assumed where no grade is given.
inline constexpr InsGrade kAssumedInsGrade = InsGrade::kTactical;

/// How the position error grows without fixes: a grade or a product (ins_products.h), and figures that replace those of
/// either. Units are those of
/// datasheets; every figure is one standard deviation of one axis. With grade `custom` a figure not given is 0.
struct InsOptions {
  std::optional<InsGrade> grade;
  std::optional<std::string> name;
  double sigma_multiple = 3;
  double fix_sigma_m = 2;
  double start_sigma_m = 3;
  std::optional<double> accel_bias_mg;
  std::optional<double> gyro_bias_deg_h;
  std::optional<double> velocity_random_walk_mps_rt_h;
  std::optional<double> angle_random_walk_deg_rt_h;
  std::optional<double> accel_scale_ppm;
  std::optional<double> gyro_scale_ppm;
  std::optional<double> bias_correlation_s;
  std::optional<double> start_velocity_sigma_mps;
  std::optional<double> start_tilt_sigma_deg;
  std::optional<double> start_heading_sigma_deg;
  std::optional<double> odometry_drift_percent;
  std::optional<double> velocity_aid_sigma_mps;
  double velocity_aid_correlation_s = 300;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field(
        "grade", self.grade,
        "Class of the inertial system, which sets every figure below that is not given; tactical is assumed, with a "
        "warning, if neither it nor a name is given.");
    fields.field(
        "name", self.name,
        "An inertial unit by the name it is sold under, as \"VN-100\", in place of the grade: the figures that "
        "its data sheet states, the others of its class; list names all.");
    fields.field("sigma_multiple", self.sigma_multiple, "k: errors are stated as k standard deviations.",
                 Range{0.5, 10});
    fields.field("fix_sigma_m", self.fix_sigma_m, "Error of a position fix by sight, each axis.", Range{0.01, 1000});
    fields.field("start_sigma_m", self.start_sigma_m, "Error of the position when GNSS is lost, each axis.",
                 Range{0.01, 1000});
    fields.field("accel_bias_mg", self.accel_bias_mg, "Accelerometer bias left after alignment.", Range{0, 100});
    fields.field("gyro_bias_deg_h", self.gyro_bias_deg_h, "Gyro bias left after alignment.", Range{0, 10000});
    fields.field("velocity_random_walk_mps_rt_h", self.velocity_random_walk_mps_rt_h,
                 "Accelerometer noise, m/s per root hour.", Range{0, 100});
    fields.field("angle_random_walk_deg_rt_h", self.angle_random_walk_deg_rt_h, "Gyro noise, degrees per root hour.",
                 Range{0, 100});
    fields.field("accel_scale_ppm", self.accel_scale_ppm, "Accelerometer scale error.", Range{0, 100000});
    fields.field("gyro_scale_ppm", self.gyro_scale_ppm, "Gyro scale error.", Range{0, 100000});
    fields.field("bias_correlation_s", self.bias_correlation_s,
                 "Time over which the biases wander (first-order Gauss-Markov); 0 = they stay constant.",
                 Range{0, 1e6});
    fields.field("start_velocity_sigma_mps", self.start_velocity_sigma_mps,
                 "Velocity error when GNSS is lost, each axis.", Range{0, 100});
    fields.field("start_tilt_sigma_deg", self.start_tilt_sigma_deg, "Roll and pitch error when GNSS is lost.",
                 Range{0, 45});
    fields.field("start_heading_sigma_deg", self.start_heading_sigma_deg, "Heading error when GNSS is lost.",
                 Range{0, 180});
    fields.field(
        "odometry_drift_percent", self.odometry_drift_percent,
        "Visual odometry: radial drift (rms) in percent of the distance flown; above 0 it replaces the integration "
        "of accelerations.",
        Range{0, 50});
    fields.field(
        "velocity_aid_sigma_mps", self.velocity_aid_sigma_mps,
        "Error of a velocity that bounds the drift, each axis: wind estimate with airspeed, Doppler, optical flow.",
        Range{0.001, 100});
    fields.field("velocity_aid_correlation_s", self.velocity_aid_correlation_s,
                 "Time over which the error of the aiding velocity changes.", Range{1, 1e6});
  }
};

}  // namespace pilotage

#pragma GCC visibility pop
