#include "pilotage/ins/ins_error_model.h"

#include "pilotage/base/angle.h"
#include "pilotage/base/error.h"
#include "pilotage/ins/ins_products.h"

namespace pilotage {
namespace {

constexpr double kHour_s = 3600;
constexpr double kRootHour = 60;  // √3600 s
constexpr double kStandardGravity_mps2 = 9.80665;

/// Figures of a grade in datasheet units, one standard deviation of one axis.
struct GradeFigures {
  double accel_bias_mg;
  double gyro_bias_deg_h;
  double velocity_random_walk_mps_rt_h;
  double angle_random_walk_deg_rt_h;
  double accel_scale_ppm;
  double gyro_scale_ppm;
  double bias_correlation_s;
  double start_velocity_sigma_mps;
  double start_tilt_sigma_deg;
  double start_heading_sigma_deg;
  double odometry_drift_percent;
};

// docs/methods/ins.md says for each number whether it is published, converted or representative.
GradeFigures grade_figures(InsGrade grade) {
  switch (grade) {
    case InsGrade::kConsumer:
      return {3, 50, 0.1353, 0.9, 5000, 5000, 1000, 0.3, 1.0, 3.0, 0};
    case InsGrade::kIndustrial:
      return {0.5, 15, 0.037, 0.48, 1000, 1000, 1000, 0.1, 0.3, 1.0, 0};
    case InsGrade::kTactical:
      return {0.75, 5, 0.06, 0.15, 300, 500, 1000, 0.05, 0.05, 0.3, 0};
    case InsGrade::kNavigation:
      return {0.025, 0.0035, 0.003, 0.002, 100, 5, 3600, 0.03, 0.0025, 0.02, 0};
    case InsGrade::kVisualOdometry:
      return {0, 15, 0, 0.48, 0, 1000, 1000, 0, 0.3, 1.0, 1.0};
    case InsGrade::kCustom:
      return {};
  }
  return {};
}

/// Of the grade, or of the product with what its data sheet leaves open taken from its class.
GradeFigures figures_of(const InsOptions& options) {
  if (!options.name) return grade_figures(options.grade.value_or(kAssumedInsGrade));
  const InsProduct& product = ins_product(*options.name);
  if (options.grade) {
    throw UsageError("--ins-grade and --ins-name exclude each other: " + std::string(product.name) +
                     " is of the class " + options_detail::enum_to_name(product.grade) +
                     "; give the inertial system in one way");
  }
  GradeFigures figures = grade_figures(product.grade);
  const auto take = [](double stated, double& figure) {
    if (stated > 0) figure = stated;
  };
  take(product.accel_bias_mg, figures.accel_bias_mg);
  take(product.gyro_bias_deg_h, figures.gyro_bias_deg_h);
  take(product.velocity_random_walk_mps_rt_h, figures.velocity_random_walk_mps_rt_h);
  take(product.angle_random_walk_deg_rt_h, figures.angle_random_walk_deg_rt_h);
  take(product.accel_scale_ppm, figures.accel_scale_ppm);
  take(product.gyro_scale_ppm, figures.gyro_scale_ppm);
  return figures;
}

}  // namespace

InsErrorModel make_ins_error_model(const InsOptions& options) {
  check_options(options);
  const GradeFigures grade = figures_of(options);
  InsErrorModel model;
  model.accel_bias_mps2 = options.accel_bias_mg.value_or(grade.accel_bias_mg) * 1e-3 * kStandardGravity_mps2;
  model.gyro_bias_radps = options.gyro_bias_deg_h.value_or(grade.gyro_bias_deg_h) * kRadPerDeg / kHour_s;
  model.velocity_random_walk_mps_rt_s =
      options.velocity_random_walk_mps_rt_h.value_or(grade.velocity_random_walk_mps_rt_h) / kRootHour;
  model.angle_random_walk_rad_rt_s =
      options.angle_random_walk_deg_rt_h.value_or(grade.angle_random_walk_deg_rt_h) * kRadPerDeg / kRootHour;
  model.accel_scale = options.accel_scale_ppm.value_or(grade.accel_scale_ppm) * 1e-6;
  model.gyro_scale = options.gyro_scale_ppm.value_or(grade.gyro_scale_ppm) * 1e-6;
  model.bias_correlation_s = options.bias_correlation_s.value_or(grade.bias_correlation_s);
  model.start_velocity_sigma_mps = options.start_velocity_sigma_mps.value_or(grade.start_velocity_sigma_mps);
  model.start_tilt_sigma_rad = options.start_tilt_sigma_deg.value_or(grade.start_tilt_sigma_deg) * kRadPerDeg;
  model.start_heading_sigma_rad = options.start_heading_sigma_deg.value_or(grade.start_heading_sigma_deg) * kRadPerDeg;
  model.odometry_drift = options.odometry_drift_percent.value_or(grade.odometry_drift_percent) * 1e-2;
  model.velocity_aid_sigma_mps = options.velocity_aid_sigma_mps.value_or(0);
  model.velocity_aid_correlation_s = options.velocity_aid_correlation_s;
  model.start_sigma_m = options.start_sigma_m;
  model.fix_sigma_m = options.fix_sigma_m;
  model.sigma_multiple = options.sigma_multiple;
  if (options.bias_correlation_s && *options.bias_correlation_s > 0 && *options.bias_correlation_s < 1) {
    throw UsageError("bias_correlation_s is below 1; a bias that wanders this fast is noise: give it as random walk");
  }
  const bool grows = model.accel_bias_mps2 > 0 || model.gyro_bias_radps > 0 ||
                     model.velocity_random_walk_mps_rt_s > 0 || model.angle_random_walk_rad_rt_s > 0 ||
                     model.start_velocity_sigma_mps > 0 || model.start_tilt_sigma_rad > 0 || model.odometry_drift > 0;
  if (!grows) {
    throw UsageError(
        "grade = custom needs figures that make the error grow: accel_bias_mg, gyro_bias_deg_h, "
        "velocity_random_walk_mps_rt_h, angle_random_walk_deg_rt_h, start_velocity_sigma_mps, "
        "start_tilt_sigma_deg or odometry_drift_percent");
  }
  return model;
}

}  // namespace pilotage
