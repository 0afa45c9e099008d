#pragma once
#include <rclcpp/rclcpp.hpp>
namespace px4_msgs::msg {
struct AuxGlobalPosition {
  std::uint64_t timestamp = 0, timestamp_sample = 0;
  std::uint8_t id = 0, source = 0;
  double lat = 0, lon = 0;
  float alt = 0, eph = 0, epv = 0;
  std::uint8_t lat_lon_reset_counter = 9;
};
}  // namespace px4_msgs::msg
