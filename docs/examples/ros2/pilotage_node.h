// A node that finds pictures in an onboard map. README.md beside this file names topics and parameters.
#pragma once

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <deque>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <diagnostic_msgs/msg/diagnostic_array.hpp>
#include <opencv2/core.hpp>
#include <pilotage/onboard.h>
#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/image.hpp>
#include <sensor_msgs/msg/imu.hpp>
#include <sensor_msgs/msg/nav_sat_fix.hpp>
#include <sensor_msgs/msg/range.hpp>
#ifdef PILOTAGE_HAS_PX4_MSGS
#include <px4_msgs/msg/aux_global_position.hpp>
#endif

#include "messages.h"

namespace pilotage_ros {

class PilotageNode : public rclcpp::Node {
 public:
  /// Throws what MapReader::open() and check_purpose() throw, and std::runtime_error for parameters that are missing.
  PilotageNode() : Node("pilotage"), map_(open_map()) {
    if (!map_.camera()) throw std::runtime_error("the map does not say for which camera it was prepared");
    frame_id_ = declare_parameter<std::string>("frame_id", "base_link");
    max_speed_mps_ = declare_parameter<double>("max_speed_mps", 30.0);
    max_prior_age_s_ = declare_parameter<double>("max_prior_age_s", 0.5);
    max_attitude_age_s_ = declare_parameter<double>("max_attitude_age_s", 0.05);
    geoid_m_ = declare_parameter<double>("geoid_m", std::numeric_limits<double>::quiet_NaN());
    source_id_ = static_cast<int>(declare_parameter<int>("px4_source_id", 1));
    options_.deadline_ms = declare_parameter<double>("deadline_ms", 1000.0);

    fixes_ = create_publisher<sensor_msgs::msg::NavSatFix>("~/fix", 10);
    diagnostics_ = create_publisher<diagnostic_msgs::msg::DiagnosticArray>("/diagnostics", 10);
#ifdef PILOTAGE_HAS_PX4_MSGS
    positions_ = create_publisher<px4_msgs::msg::AuxGlobalPosition>("/fmu/in/aux_global_position", 10);
#endif
    const auto remember = [](auto& history, const auto& message) {
      constexpr std::size_t kMost = 500;
      history.push_back(*message);
      if (history.size() > kMost) history.pop_front();
    };
    priors_in_ = create_subscription<sensor_msgs::msg::NavSatFix>(
        "prior", rclcpp::SensorDataQoS(),
        [this, remember](const sensor_msgs::msg::NavSatFix::ConstSharedPtr& message) { remember(priors_, message); });
    attitudes_in_ = create_subscription<sensor_msgs::msg::Imu>(
        "imu", rclcpp::SensorDataQoS(),
        [this, remember](const sensor_msgs::msg::Imu::ConstSharedPtr& message) { remember(attitudes_, message); });
    ranges_in_ = create_subscription<sensor_msgs::msg::Range>(
        "height_above_ground", rclcpp::SensorDataQoS(),
        [this, remember](const sensor_msgs::msg::Range::ConstSharedPtr& message) { remember(ranges_, message); });
    images_in_ = create_subscription<sensor_msgs::msg::Image>(
        "image", rclcpp::SensorDataQoS(),
        [this](const sensor_msgs::msg::Image::ConstSharedPtr& message) { take_picture(*message); });
  }

 private:
  pilotage::MapReader open_map() {
    const auto path = declare_parameter<std::string>("map", "");
    const auto public_key = declare_parameter<std::string>("public_key", "");
    if (path.empty()) throw std::runtime_error("parameter map: which onboard map?");
    if (declare_parameter<bool>("unverified", false)) return pilotage::MapReader::open_unverified(path);
    if (public_key.empty()) throw std::runtime_error("parameter public_key: whose signature is trusted? Or unverified");
    pilotage::MapReader map = pilotage::MapReader::open(path, {public_key});
    pilotage::MapRequirements required;
    required.now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
    pilotage::check_purpose(map, required);
    return map;
  }

  /// The message whose stamp is nearest to that time; nothing where it is farther than `age_s`.
  template <class Message>
  static const Message* nearest(const std::deque<Message>& history, std::int64_t time_ns, double age_s) {
    const Message* best = nullptr;
    auto least_ns = static_cast<std::int64_t>(age_s * 1e9);
    for (const Message& message : history) {
      const std::int64_t apart_ns = std::abs(nanoseconds_of(message.header.stamp) - time_ns);
      if (apart_ns > least_ns) continue;
      least_ns = apart_ns;
      best = &message;
    }
    return best;
  }

  /// What is believed of the aircraft at that time. Without a word of why, where something is missing: `missing` has
  /// it.
  std::optional<pilotage::MatchPrior> prior_at(std::int64_t time_ns, std::string& missing,
                                               pilotage::FixAltitude& altitude) const {
    const auto* position = nearest(priors_, time_ns, max_prior_age_s_);
    const auto* imu = nearest(attitudes_, time_ns, max_attitude_age_s_);
    const auto* range = nearest(ranges_, time_ns, max_prior_age_s_);
    constexpr std::uint8_t kUnknownCovariance = 0;
    if (position == nullptr || position->status.status < 0) missing = "no prior position";
    if (position != nullptr && position->position_covariance_type == kUnknownCovariance)
      missing = "a prior without covariance";
    if (imu == nullptr || imu->orientation_covariance[0] < 0) missing = "no attitude";
    if (range == nullptr || !(range->range > range->min_range && range->range < range->max_range)) missing = "no range";
    if (!missing.empty()) return std::nullopt;
    pilotage::MatchPrior prior;
    prior.position = {position->longitude, position->latitude};
    const auto& covariance = position->position_covariance;  // east, north, up
    prior.covariance_en_m2 << covariance[0], covariance[1], covariance[3], covariance[4];
    // It was believed some time before or after: the aircraft flew meanwhile.
    const double flown_m = max_speed_mps_ * std::abs(nanoseconds_of(position->header.stamp) - time_ns) / 1e9;
    prior.covariance_en_m2 += Eigen::Matrix2d::Identity() * flown_m * flown_m;
    prior.attitude = attitude_of(imu->orientation);
    constexpr double kRadians = std::numbers::pi / 180;
    prior.height_agl_m = static_cast<double>(range->range) * std::cos(prior.attitude.pitch_deg * kRadians) *
                         std::cos(prior.attitude.roll_deg * kRadians);
    altitude.ellipsoid_m = position->altitude;
    altitude.amsl_m = position->altitude - geoid_m_;
    altitude.sigma_m = std::sqrt(covariance[8]);
    return prior;
  }

  void take_picture(const sensor_msgs::msg::Image& image) {
    const std::int64_t exposure_ns = nanoseconds_of(image.header.stamp);
    std::string missing;
    pilotage::FixAltitude altitude;
    const auto prior = prior_at(exposure_ns, missing, altitude);
    if (image.encoding != "mono8" && image.encoding != "8UC1")
      missing = "a picture in " + image.encoding + ", not mono8";
    if (image.data.size() < std::size_t{image.step} * image.height || image.step < image.width)
      missing = "a broken picture";
    if (!prior || !missing.empty()) return diagnose(missing);
    // match() does not write to the pixels.
    const cv::Mat pixels(static_cast<int>(image.height), static_cast<int>(image.width), CV_8UC1,
                         const_cast<unsigned char*>(image.data.data()), image.step);
    pilotage::Camera camera = *map_.camera();
    try {
      camera = pilotage::camera_for_size("image", camera, pixels.cols, pixels.rows);
    } catch (const pilotage::DataError&) {  // match() has a status for it
    }
    const auto begin = std::chrono::steady_clock::now();
    pilotage::MatchResult result = pilotage::match(pixels, *prior, camera, map_, options_);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    if (result.fix) {
      // Who gave the prior has it: the picture's share alone goes back.
      const pilotage::PositionMeasurement alone = pilotage::without_prior(*result.fix, *prior);
      result.fix->position = alone.position;
      result.fix->covariance_en_m2 = alone.covariance_en_m2;
    }
    publish(result, altitude, exposure_ns, took);
  }

  void publish(const pilotage::MatchResult& result, const pilotage::FixAltitude& altitude, std::int64_t exposure_ns,
               std::chrono::duration<double> took) {
    sensor_msgs::msg::NavSatFix fix;
    set_nav_sat_fix(pilotage::nav_sat_fix(result, altitude, exposure_ns, frame_id_), fix);
    fixes_->publish(fix);
#ifdef PILOTAGE_HAS_PX4_MSGS
    if (result.fix) {
      px4_msgs::msg::AuxGlobalPosition position;
      set_aux_global_position(result, altitude, exposure_ns, now().nanoseconds(), source_id_, position);
      positions_->publish(position);
    }
#endif
    diagnostic_msgs::msg::DiagnosticArray array;
    array.header.stamp = now();
    set_diagnostic(result, took, array.status.emplace_back());
    diagnostics_->publish(array);
  }

  /// A picture that could not be tried.
  void diagnose(const std::string& missing) {
    diagnostic_msgs::msg::DiagnosticArray array;
    array.header.stamp = now();
    auto& status = array.status.emplace_back();
    status.level = diagnostic_msgs::msg::DiagnosticStatus::ERROR;
    status.name = "pilotage: position by sight";
    status.message = "not tried: " + missing;
    diagnostics_->publish(array);
  }

  pilotage::MapReader map_;
  pilotage::MatchOptions options_;
  std::string frame_id_;
  double max_speed_mps_ = 0, max_prior_age_s_ = 0, max_attitude_age_s_ = 0, geoid_m_ = 0;
  int source_id_ = 1;
  std::deque<sensor_msgs::msg::NavSatFix> priors_;
  std::deque<sensor_msgs::msg::Imu> attitudes_;
  std::deque<sensor_msgs::msg::Range> ranges_;
  rclcpp::Publisher<sensor_msgs::msg::NavSatFix>::SharedPtr fixes_;
  rclcpp::Publisher<diagnostic_msgs::msg::DiagnosticArray>::SharedPtr diagnostics_;
#ifdef PILOTAGE_HAS_PX4_MSGS
  rclcpp::Publisher<px4_msgs::msg::AuxGlobalPosition>::SharedPtr positions_;
#endif
  rclcpp::Subscription<sensor_msgs::msg::NavSatFix>::SharedPtr priors_in_;
  rclcpp::Subscription<sensor_msgs::msg::Imu>::SharedPtr attitudes_in_;
  rclcpp::Subscription<sensor_msgs::msg::Range>::SharedPtr ranges_in_;
  rclcpp::Subscription<sensor_msgs::msg::Image>::SharedPtr images_in_;
};

}  // namespace pilotage_ros
