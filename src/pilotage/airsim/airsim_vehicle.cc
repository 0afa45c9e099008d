#include "pilotage/airsim/airsim_vehicle.h"

#include <algorithm>
#include <cmath>

#include "pilotage/airsim/airsim_geometry.h"
#include "pilotage/base/angle.h"

namespace pilotage {
namespace {

constexpr double kStepS = 0.02;
constexpr double kTurnDegps = 90;
constexpr double kMostClimbMps = 2;

void take_finite(float& to, float from) {
  if (!std::isnan(from)) to = from;
}

}  // namespace

void AirsimVehicle::put(const AirsimPose& pose) {
  AirsimPose now = this->pose();
  take_finite(now.position.x_val, pose.position.x_val);
  take_finite(now.position.y_val, pose.position.y_val);
  take_finite(now.position.z_val, pose.position.z_val);
  const AirsimQuaternion& q = pose.orientation;
  if (!std::isnan(q.w_val + q.x_val + q.y_val + q.z_val)) now.orientation = q;
  position_m = vector_of(now.position);
  orientation = now.orientation;
  velocity_mps.setZero();
  yaw_rate_radps = 0;
}

AirsimPose AirsimVehicle::pose() const {
  return {airsim_vector(position_m), orientation};
}

AirsimKinematics AirsimVehicle::kinematics() const {
  AirsimKinematics kinematics;
  kinematics.position = airsim_vector(position_m);
  kinematics.orientation = orientation;
  kinematics.linear_velocity = airsim_vector(velocity_mps);
  kinematics.angular_velocity.z_val = static_cast<float>(yaw_rate_radps);
  return kinematics;
}

void AirsimVehicle::begin(const AirsimMotion& motion) {
  stop();
  motion_ = motion;
  next_ = 0;
  flies = true;
}

void AirsimVehicle::stop() {
  motion_.reset();
  velocity_mps.setZero();
  yaw_rate_radps = 0;
}

std::optional<bool> AirsimVehicle::advance(double seconds) {
  while (motion_ && seconds > 0) {
    const double step_s = std::min({seconds, kStepS, std::max(motion_->left_s, 1e-9)});
    seconds -= step_s;
    const std::optional<bool> done = step(step_s);
    if (!done) continue;
    if (*done && motion_->lands) flies = false;
    stop();
    return done;
  }
  return std::nullopt;
}

/// Whether the motion ended, and well.
std::optional<bool> AirsimVehicle::step(double seconds) {
  motion_->left_s -= seconds;
  const bool follows = !motion_->path.empty();
  bool arrived = false;
  if (follows) {
    arrived = follow_path(seconds);
  } else {
    fly_velocity(seconds);
  }
  turn(seconds);
  if (arrived) return true;
  if (motion_->left_s > 1e-9) return std::nullopt;
  return !follows;
}

void AirsimVehicle::fly_velocity(double seconds) {
  velocity_mps = motion_->velocity_mps;
  if (motion_->in_body_frame) {
    const double yaw_rad = attitude_of(rotation_of(orientation)).yaw_deg * kRadPerDeg;
    const Eigen::Vector2d ahead(std::cos(yaw_rad), std::sin(yaw_rad));
    velocity_mps.head<2>() =
        motion_->velocity_mps.x() * ahead + motion_->velocity_mps.y() * Eigen::Vector2d(-ahead.y(), ahead.x());
  }
  if (motion_->hold_down_m) {
    velocity_mps.z() = std::clamp((*motion_->hold_down_m - position_m.z()) / seconds, -kMostClimbMps, kMostClimbMps);
  }
  position_m += velocity_mps * seconds;
}

bool AirsimVehicle::follow_path(double seconds) {
  double way_m = motion_->speed_mps * seconds;
  const Eigen::Vector3d before = position_m;
  while (next_ < motion_->path.size()) {
    const Eigen::Vector3d to = motion_->path[next_] - position_m;
    if (to.norm() > way_m) {
      position_m += to.normalized() * way_m;
      break;
    }
    way_m -= to.norm();
    position_m = motion_->path[next_++];
  }
  velocity_mps = (position_m - before) / seconds;
  return next_ == motion_->path.size();
}

/// The nose ahead, by a rate, or to a heading.
void AirsimVehicle::turn(double seconds) {
  const double yaw_deg = attitude_of(rotation_of(orientation)).yaw_deg;
  const AirsimYawMode& mode = motion_->yaw;
  double by_deg = static_cast<double>(mode.yaw_or_rate) * seconds;
  const bool has_direction = velocity_mps.head<2>().norm() > 1e-6;
  if (motion_->nose_ahead || !mode.is_rate) {
    double to_deg =
        motion_->nose_ahead && has_direction ? std::atan2(velocity_mps.y(), velocity_mps.x()) / kRadPerDeg : yaw_deg;
    if (!motion_->nose_ahead) to_deg = static_cast<double>(mode.yaw_or_rate);
    const double most_deg = kTurnDegps * seconds;
    by_deg = std::clamp(std::remainder(to_deg - yaw_deg, 360.0), -most_deg, most_deg);
  }
  orientation = quaternion_of(ned_from_body({yaw_deg + by_deg, 0, 0}));
  yaw_rate_radps = by_deg * kRadPerDeg / seconds;
}

}  // namespace pilotage
