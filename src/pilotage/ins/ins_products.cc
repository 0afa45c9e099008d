#include "pilotage/ins/ins_products.h"

#include <vector>

#include "pilotage/base/error.h"
#include "pilotage/base/product_name.h"

namespace pilotage {
namespace {

/// The noise of the two sensors as data sheets of chips and modules state it, in °/s/√Hz and µg/√Hz; biases and scale
/// errors of such parts are those of the class, because their data sheets state them before calibration.
InsProduct by_noise(std::string_view name, std::string_view also, InsGrade grade, double gyro_noise_deg_s_rt_hz,
                    double accel_noise_ug_rt_hz, std::string_view source, bool confirmed = true) {
  constexpr double kPerRootHour = 60;  // √3600 s
  constexpr double kMicroG_mps2 = 9.80665e-6;
  InsProduct product;
  product.name = name;
  product.also = also;
  product.grade = grade;
  product.angle_random_walk_deg_rt_h = kPerRootHour * gyro_noise_deg_s_rt_hz;
  product.velocity_random_walk_mps_rt_h = kPerRootHour * kMicroG_mps2 * accel_noise_ug_rt_hz;
  product.confirmed = confirmed;
  product.source = source;
  return product;
}

const std::vector<InsProduct>& product_list() {
  using enum InsGrade;
  static const std::vector<InsProduct> kProducts = {
      {"ADIS16448", "", kIndustrial, 0.66, 0.11, 0, 0, 0, 0, true, "Analog Devices, ADIS16448 data sheet"},
      by_noise("ADIS16470", "", kIndustrial, 0.008, 100, "Analog Devices, ADIS16470 data sheet, rev. C"),
      {"ADIS16490", "", kTactical, 0.09, 0, 0, 0, 0, 0, true, "Analog Devices, ADIS16490 data sheet"},
      {"ADIS16507", "", kIndustrial, 0.15, 0.012, 0, 0, 0, 0, false, "Analog Devices, ADIS16507 data sheet"},
      by_noise("BMI055", "", kConsumer, 0.014, 150, "Bosch, BST-BMI055-DS000"),
      by_noise("BMI088", "", kConsumer, 0.014, 190, "Bosch, BST-BMI088-DS001, rev. 1.9"),
      {"HG1700", "HG1700 AG58", kTactical, 0.125, 0.0198, 1, 1, 0, 0, true, "Honeywell, N61-1619"},
      {"HG4930", "HG4930CA51", kTactical, 0.04, 0.03, 7, 1.7, 0, 0, false,
       "Honeywell, HG4930 performance and environmental manual, July 2017"},
      {"HG9900", "", kNavigation, 0.002, 0, 0.0035, 0.025, 5, 100, true, "Honeywell, N61-1638"},
      by_noise("ICM-20602", "", kConsumer, 0.004, 100, "TDK InvenSense, DS-000176"),
      by_noise("ICM-20689", "", kConsumer, 0.006, 150, "TDK InvenSense, DS-000143", false),
      by_noise("ICM-20948", "", kConsumer, 0.015, 230, "TDK InvenSense, DS-000189"),
      by_noise("ICM-42688-P", "ICM-42688", kConsumer, 0.0028, 70, "TDK InvenSense, DS-000347"),
      by_noise("ICM-45686", "", kConsumer, 0.0038, 70, "TDK InvenSense, DS-000577", false),
      by_noise("MPU-6000", "MPU-6050", kConsumer, 0.005, 400, "InvenSense, PS-MPU-6000A-00"),
      {"STIM300", "", kTactical, 0.15, 0.06, 5, 0.75, 500, 300, true, "Sensonor, STIM300 data sheet"},
      by_noise("VN-100", "VectorNav VN-100", kIndustrial, 0.0035, 140, "VectorNav, VN-100 data sheet"),
      by_noise("VN-200", "VectorNav VN-200", kIndustrial, 0.0035, 140, "VectorNav, VN-200 data sheet"),
      by_noise("VN-300", "VectorNav VN-300", kIndustrial, 0.0035, 140, "VectorNav, VN-300 data sheet"),
      by_noise("Xsens MTi-1", "MTi-1", kIndustrial, 0.007, 120, "Xsens, MTi 1-series data sheet"),
      by_noise("Xsens MTi-630", "MTi-630", kIndustrial, 0.007, 60, "Xsens, MTi 600-series data sheet"),
  };
  return kProducts;
}

bool has_own_figures(const InsOptions& options) {
  return options.accel_bias_mg || options.gyro_bias_deg_h || options.velocity_random_walk_mps_rt_h ||
         options.angle_random_walk_deg_rt_h || options.accel_scale_ppm || options.gyro_scale_ppm ||
         options.bias_correlation_s || options.start_velocity_sigma_mps || options.start_tilt_sigma_deg ||
         options.start_heading_sigma_deg || options.odometry_drift_percent;
}

}  // namespace

std::span<const InsProduct> ins_products() {
  return product_list();
}

const InsProduct& ins_product(std::string_view name) {
  std::vector<ProductName> names;
  for (const InsProduct& product : product_list()) names.push_back({product.name, product.also});
  return product_list()[product_of_name(
      name, names, {"inertial unit", "--ins-name", "any other can be given by its grade and its figures (--ins-…)"})];
}

std::string ins_text(const InsOptions& options) {
  const std::string own = has_own_figures(options) ? ", with figures of your own" : "";
  if (!options.name) {
    return options_detail::enum_to_name(options.grade.value_or(kAssumedInsGrade)) + " INS" +
           (options.grade ? "" : " (default)") + own;
  }
  const InsProduct& product = ins_product(*options.name);
  return std::string(product.name) + " INS" + (product.confirmed ? "" : " (its figures are not confirmed)") + own;
}

}  // namespace pilotage
