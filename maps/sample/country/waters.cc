#include "country/waters.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "country/noise.h"
#include "pilotage/base/random.h"

namespace pilotage::scene_detail {

Waters make_waters(std::uint64_t seed, double width_m, double height_m) {
  Random random(seed);
  Waters waters;
  waters.seed = seed;
  waters.width_m = width_m;
  waters.height_m = height_m;
  waters.lake_center_m = {width_m * random.uniform(0.27, 0.31), height_m * random.uniform(0.79, 0.82)};
  waters.lake_radii_m = {random.uniform(370, 420), random.uniform(200, 230)};
  return waters;
}

double Waters::lake_depth_m(const Eigen::Vector2d& p) const {
  const Eigen::Vector2d d = (p - lake_center_m).cwiseQuotient(lake_radii_m);
  const double bays = 38.0 * gradient_noise(seed + 1, p.x() / 170, p.y() / 170) +
                      9.0 * gradient_noise(seed + 2, p.x() / 45, p.y() / 45);
  return (1 - d.norm()) * lake_radii_m.minCoeff() + bays;
}

double Waters::river_depth_m(const Eigen::Vector2d& p) const {
  const double phase = 2 * std::numbers::pi * hash_part(lattice_hash(seed, 7, 7), 0);
  const double a = 2 * std::numbers::pi * p.x() / 1250 + phase;
  const double b = 2 * std::numbers::pi * p.x() / 430 + 2.3 * phase;
  const double axis = height_m * 0.60 - 0.06 * (p.x() - width_m / 2) + 62 * std::sin(a) + 17 * std::sin(b);
  const double slope =
      -0.06 + 62 * 2 * std::numbers::pi / 1250 * std::cos(a) + 17 * 2 * std::numbers::pi / 430 * std::cos(b);
  const double half_width = 12.5 + 3.5 * gradient_noise(seed + 3, p.x() / 140, 0.5);
  return half_width - std::abs(p.y() - axis) / std::hypot(1.0, slope);
}

}  // namespace pilotage::scene_detail
