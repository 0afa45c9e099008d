#include "pilotage/navigate/strapdown.h"

#include <algorithm>
#include <cmath>

#include "pilotage/base/angle.h"
#include "pilotage/geo/ecef.h"

namespace pilotage {
namespace {

constexpr double kGravitationalConstant_m3ps2 = 3.986004418e14;  // WGS 84
constexpr double kJ2 = 1.082627e-3;                              // WGS 84
constexpr double kJ4 = -2.37091222e-6;                           // WGS 84
constexpr double kEquator_m = 6378137.0;

Eigen::Quaterniond rotation_by(const Eigen::Vector3d& vector_rad) {
  const double half_rad = 0.5 * vector_rad.norm();
  // sin(x)/x, whose series leaves 1e-17 here.
  const double scale = half_rad < 1e-4 ? 0.5 * (1 - half_rad * half_rad / 6) : 0.5 * std::sin(half_rad) / half_rad;
  Eigen::Quaterniond rotation;
  rotation.w() = std::cos(half_rad);
  rotation.vec() = scale * vector_rad;
  return rotation;
}

Eigen::Matrix3d ned_from_enu() {
  Eigen::Matrix3d axes;
  axes << 0, 1, 0, 1, 0, 0, 0, 0, -1;
  return axes;
}

}  // namespace

Eigen::Vector3d gravity_mps2(const Eigen::Vector3d& position_m) {
  const double r2 = position_m.squaredNorm();
  const double r = std::sqrt(r2);
  const double a2 = kEquator_m * kEquator_m / r2;
  const double z2 = position_m.z() * position_m.z() / r2;
  const double level = 1 + 1.5 * kJ2 * a2 * (1 - 5 * z2) - 1.875 * kJ4 * a2 * a2 * (1 - 14 * z2 + 21 * z2 * z2);
  const double axial = 1 + 1.5 * kJ2 * a2 * (3 - 5 * z2) - 0.625 * kJ4 * a2 * a2 * (15 - 70 * z2 + 63 * z2 * z2);
  const Eigen::Vector3d shape(level, level, axial);
  Eigen::Vector3d gravity = -kGravitationalConstant_m3ps2 / (r2 * r) * position_m.cwiseProduct(shape);
  gravity.head<2>() += kEarthRate_radps * kEarthRate_radps * position_m.head<2>();
  return gravity;
}

InertialState advance(const InertialState& state, const ImuIncrement& now, const ImuIncrement& before) {
  const double dt_s = now.dt_s;
  const Eigen::Vector3d earth_rate_radps(0, 0, kEarthRate_radps);
  const Eigen::Vector3d turned_rad = now.angle_rad + before.angle_rad.cross(now.angle_rad) / 12;
  const Eigen::Vector3d pushed_mps =
      now.velocity_mps + 0.5 * now.angle_rad.cross(now.velocity_mps) +
      now.angle_rad.cross(now.angle_rad.cross(now.velocity_mps)) / 6 +
      (before.angle_rad.cross(now.velocity_mps) + before.velocity_mps.cross(now.angle_rad)) / 12;

  InertialState next;
  next.time_s = state.time_s + dt_s;
  const Eigen::Vector3d along_mps = rotation_by(-0.5 * dt_s * earth_rate_radps) * (state.ecef_from_body * pushed_mps);
  const auto change_mps = [&](const Eigen::Vector3d& position_m, const Eigen::Vector3d& velocity_mps) {
    return Eigen::Vector3d(along_mps + dt_s * (gravity_mps2(position_m) - 2 * earth_rate_radps.cross(velocity_mps)));
  };
  const Eigen::Vector3d half_way_mps = state.velocity_mps + 0.5 * change_mps(state.position_m, state.velocity_mps);
  next.velocity_mps = state.velocity_mps + change_mps(state.position_m + 0.5 * dt_s * state.velocity_mps, half_way_mps);
  next.position_m = state.position_m + 0.5 * dt_s * (state.velocity_mps + next.velocity_mps);
  next.ecef_from_body =
      (rotation_by(-dt_s * earth_rate_radps) * state.ecef_from_body * rotation_by(turned_rad)).normalized();
  return next;
}

InertialState inertial_state(double time_s, GeodeticPoint point, double height_m,
                             const Eigen::Vector3d& velocity_enu_mps, const Attitude& attitude) {
  const Eigen::Matrix3d ecef_from_enu = enu_from_ecef(point).transpose();
  InertialState state;
  state.time_s = time_s;
  state.position_m = ecef_from_geodetic(point, height_m);
  state.velocity_mps = ecef_from_enu * velocity_enu_mps;
  state.ecef_from_body =
      Eigen::Quaterniond(ecef_from_enu * ned_from_enu().transpose() * ned_from_body(attitude)).normalized();
  return state;
}

Attitude attitude_of(const InertialState& state) {
  const Eigen::Matrix3d rotation =
      ned_from_enu() * enu_from_ecef(geodetic_from_ecef(state.position_m)) * state.ecef_from_body.toRotationMatrix();
  return {std::atan2(rotation(1, 0), rotation(0, 0)) / kRadPerDeg,
          -std::asin(std::clamp(rotation(2, 0), -1.0, 1.0)) / kRadPerDeg,
          std::atan2(rotation(2, 1), rotation(2, 2)) / kRadPerDeg};
}

}  // namespace pilotage
