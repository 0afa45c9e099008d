#pragma once
#include <array>

#include <rclcpp/rclcpp.hpp>
namespace geometry_msgs::msg {
struct Quaternion {
  double x = 0, y = 0, z = 0, w = 1;
};
}  // namespace geometry_msgs::msg
namespace sensor_msgs::msg {
struct Imu {
  using ConstSharedPtr = std::shared_ptr<const Imu>;
  std_msgs::msg::Header header;
  geometry_msgs::msg::Quaternion orientation;
  std::array<double, 9> orientation_covariance{};
};
}  // namespace sensor_msgs::msg
