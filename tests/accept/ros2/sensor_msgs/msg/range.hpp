#pragma once
#include <rclcpp/rclcpp.hpp>
namespace sensor_msgs::msg {
struct Range {
  using ConstSharedPtr = std::shared_ptr<const Range>;
  std_msgs::msg::Header header;
  std::uint8_t radiation_type = 0;
  float field_of_view = 0, min_range = 0, max_range = 0, range = 0;
};
}  // namespace sensor_msgs::msg
