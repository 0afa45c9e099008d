#pragma once

#include <cstdint>

#include <Eigen/Core>

namespace pilotage::scene_detail {

/// A river that winds from the west to the east edge, and a lake.
struct Waters {
  std::uint64_t seed = 0;
  double width_m = 0;  ///< Of the scene.
  double height_m = 0;
  Eigen::Vector2d lake_center_m;
  Eigen::Vector2d lake_radii_m;

  /// Signed distance to the shore in metres, positive inside; exact to some metres only, good for levels near 0.
  double lake_depth_m(const Eigen::Vector2d& p) const;
  double river_depth_m(const Eigen::Vector2d& p) const;
};

Waters make_waters(std::uint64_t seed, double width_m, double height_m);

}  // namespace pilotage::scene_detail
