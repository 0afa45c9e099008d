// Hands the node of docs/examples/ros2 pictures and priors and prints what it publishes.
//   drive_node MAP < LINES of: PICTURE.pgm LON_DEG LAT_DEG SIGMA_M AGL_M YAW_DEG PITCH_DEG ROLL_DEG
// A word before the picture leaves something out: "attitude", "late", "color", "range".
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <sstream>

#include "pilotage_node.h"
#include <Eigen/Geometry>

namespace {

constexpr std::int64_t kExposure_ns = 1'900'000'000'250'000'000;

builtin_interfaces::msg::Time stamp(double later_s) {
  return rclcpp::Time(kExposure_ns + static_cast<std::int64_t>(later_s * 1e9));
}

sensor_msgs::msg::Image read_picture(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string magic;
  int white = 0;
  sensor_msgs::msg::Image image;
  file >> magic >> image.width >> image.height >> white;
  file.get();
  image.step = image.width + 5;  // rows may be longer than what they show
  image.data.resize(std::size_t{image.step} * image.height);
  for (std::uint32_t row = 0; row < image.height; ++row) {
    file.read(reinterpret_cast<char*>(image.data.data()) + std::size_t{row} * image.step, image.width);
  }
  image.encoding = "mono8";
  image.header.stamp = stamp(0);
  return image;
}

/// As an aircraft's estimator has it: turns about up, then to the left wing's axis, then the nose's.
geometry_msgs::msg::Quaternion orientation(double yaw_deg, double pitch_deg, double roll_deg) {
  constexpr double kRadians = M_PI / 180;
  const Eigen::Quaterniond turn(Eigen::AngleAxisd((90 - yaw_deg) * kRadians, Eigen::Vector3d::UnitZ()) *
                                Eigen::AngleAxisd(-pitch_deg * kRadians, Eigen::Vector3d::UnitY()) *
                                Eigen::AngleAxisd(roll_deg * kRadians, Eigen::Vector3d::UnitX()));
  return {turn.x(), turn.y(), turn.z(), turn.w()};
}

void fly(const std::string& line) {
  pilotage_ros::PilotageNode node;
  std::istringstream words(line);
  std::string without, picture;
  double lon_deg = 0, lat_deg = 0, sigma_m = 0, agl_m = 0, yaw_deg = 0, pitch_deg = 0, roll_deg = 0;
  words >> without >> picture >> lon_deg >> lat_deg >> sigma_m >> agl_m >> yaw_deg >> pitch_deg >> roll_deg;

  sensor_msgs::msg::NavSatFix prior;
  prior.header.stamp = stamp(without == "late" ? -0.7 : -0.1);
  prior.status.status = 0;
  prior.latitude = lat_deg;
  prior.longitude = lon_deg;
  prior.altitude = 170;
  prior.position_covariance = {sigma_m * sigma_m, 0, 0, 0, sigma_m * sigma_m, 0, 0, 0, 16};
  prior.position_covariance_type = 3;
  node.receive("prior", prior);

  for (const double later_s : {-0.2, 0.02, 0.2}) {  // the nearest counts
    sensor_msgs::msg::Imu imu;
    imu.header.stamp = stamp(later_s);
    imu.orientation = later_s == 0.02 ? orientation(yaw_deg, pitch_deg, roll_deg) : orientation(0, 0, 0);
    if (without != "attitude" || later_s != 0.02) node.receive("imu", imu);
  }
  sensor_msgs::msg::Range range;
  range.header.stamp = stamp(0.05);
  range.min_range = 1;
  range.max_range = without == "range" ? 50 : 500;
  constexpr double kRadians = M_PI / 180;
  range.range = static_cast<float>(agl_m / std::cos(pitch_deg * kRadians) / std::cos(roll_deg * kRadians));
  node.receive("height_above_ground", range);
  sensor_msgs::msg::Image image = read_picture(picture);
  if (without == "color") image.encoding = "bgr8";
  node.receive("image", image);

  const auto& attitude = pilotage_ros::attitude_of(orientation(yaw_deg, pitch_deg, roll_deg));
  std::printf("{\"attitude\": [%.6f, %.6f, %.6f]", attitude.yaw_deg, attitude.pitch_deg, attitude.roll_deg);
  for (const auto& fix : node.published<sensor_msgs::msg::NavSatFix>("~/fix")) {
    std::printf(", \"fix\": {\"status\": %d, \"stamp\": [%d, %u], \"frame\": \"%s\", \"east_m2\": %.6f, \"type\": %d",
                fix.status.status, fix.header.stamp.sec, fix.header.stamp.nanosec, fix.header.frame_id.c_str(),
                fix.position_covariance[0], fix.position_covariance_type);
    if (fix.status.status >= 0)
      std::printf(", \"lon\": %.9f, \"lat\": %.9f, \"altitude\": %.3f", fix.longitude, fix.latitude, fix.altitude);
    std::printf("}");
  }
  for (const auto& aux : node.published<px4_msgs::msg::AuxGlobalPosition>("/fmu/in/aux_global_position")) {
    std::printf(
        ", \"aux\": {\"timestamp\": %llu, \"sample\": %llu, \"id\": %d, \"source\": %d, \"lon\": %.9f, \"lat\": %.9f, "
        "\"alt\": %.3f, \"eph\": %.4f, \"epv\": %.3f, \"resets\": %d}",
        static_cast<unsigned long long>(aux.timestamp), static_cast<unsigned long long>(aux.timestamp_sample), aux.id,
        aux.source, aux.lon, aux.lat, static_cast<double>(aux.alt), static_cast<double>(aux.eph),
        static_cast<double>(aux.epv), aux.lat_lon_reset_counter);
  }
  for (const auto& array : node.published<diagnostic_msgs::msg::DiagnosticArray>("/diagnostics")) {
    std::printf(", \"level\": %d, \"message\": \"%s\", \"values\": %zu", array.status.at(0).level,
                array.status[0].message.c_str(), array.status[0].values.size());
  }
  std::printf("}\n");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2) rclcpp::parameters["map"] = std::string(argv[1]);
  rclcpp::parameters["unverified"] = argc == 2;
  rclcpp::parameters["geoid_m"] = 31.5;
  rclcpp::parameters["deadline_ms"] = 60000.0;  // a machine under load is slow, not broken
  rclcpp::parameters["px4_source_id"] = std::int64_t{3};
  try {
    for (std::string line; std::getline(std::cin, line);) fly(line);
  } catch (const std::exception& error) {
    std::printf("%s\n", error.what());
    return 1;
  }
  return 0;
}
