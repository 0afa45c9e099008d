#pragma once
#include <array>

#include <rclcpp/rclcpp.hpp>
namespace sensor_msgs::msg {
struct NavSatStatus {
  std::int8_t status = -2;
  std::uint16_t service = 0;
};
struct NavSatFix {
  using ConstSharedPtr = std::shared_ptr<const NavSatFix>;
  std_msgs::msg::Header header;
  NavSatStatus status;
  double latitude = 0, longitude = 0, altitude = 0;
  std::array<double, 9> position_covariance{};
  std::uint8_t position_covariance_type = 0;
};
}  // namespace sensor_msgs::msg
