#include "pilotage/mission/simulation.h"

#include <cmath>
#include <numbers>

#include "pilotage/base/angle.h"
#include "pilotage/base/nan.h"

namespace pilotage {

double SimulatedShare::share() const {
  return of > 0 ? static_cast<double>(count) / static_cast<double>(of) : kNaN;
}

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

SimulatedShare simulated_share(std::int64_t count, std::int64_t of) {
  return {of, count, binomial_interval(count, of)};
}

}  // namespace pilotage
