#include "pilotage/mission/simulation.h"

#include <cmath>
#include <numbers>

#include "pilotage/base/angle.h"

namespace pilotage {

std::vector<Eigen::Vector2d> ellipse_outline_m(const TruePlaceEllipse& ellipse, int corners) {
  const double azimuth_rad = ellipse.azimuth_deg * kRadPerDeg;
  const Eigen::Vector2d major = ellipse.major_m * Eigen::Vector2d(std::sin(azimuth_rad), std::cos(azimuth_rad));
  const Eigen::Vector2d minor = ellipse.minor_m * Eigen::Vector2d(std::cos(azimuth_rad), -std::sin(azimuth_rad));
  std::vector<Eigen::Vector2d> outline_m;
  for (int i = 0; i < corners; ++i) {
    const double angle_rad = 2 * std::numbers::pi * i / corners;
    outline_m.emplace_back(std::cos(angle_rad) * major + std::sin(angle_rad) * minor);
  }
  return outline_m;
}

}  // namespace pilotage
