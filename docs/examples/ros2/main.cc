#include <exception>
#include <memory>

#include "pilotage_node.h"
#include <opencv2/core.hpp>
#include <rclcpp/rclcpp.hpp>

int main(int argc, char** argv) {
  cv::setNumThreads(1);  // the other cores have other work
  rclcpp::init(argc, argv);
  try {
    rclcpp::spin(std::make_shared<pilotage_ros::PilotageNode>());
  } catch (const std::exception& error) {  // a map that cannot be flown
    RCLCPP_FATAL(rclcpp::get_logger("pilotage"), "%s", error.what());
    rclcpp::shutdown();
    return 1;
  }
  rclcpp::shutdown();
  return 0;
}
