#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace pilotage {

/// A wind, and how much it counts.
struct WindNode {
  Eigen::Vector2d wind_mps{0, 0};
  double weight = 1;
};

/// Winds that stand for a normal distribution of each axis, weights 1 together: `count` (11, 8, 5 or 3) on rings, of
/// which each stands for a share of all winds by their speed and has evenly spread directions. `shift`, from [0, 1),
/// moves the rings within their shares and turns them, so that sets with different shifts complement each other. One of
/// calm where sigma_mps = 0.
std::vector<WindNode> wind_nodes(double sigma_mps, std::size_t count, double shift);

/// A wind at a level of the place.
struct WindCase {
  std::size_t level = 0;
  WindNode node;  ///< Its weight is that at the level.
};

/// What the chances of a flight are averaged over: wind_nodes() at each of so many levels (those of level_nodes(), or
/// one), shifted by the golden ratio from level to level, so that together they are a set over wind and level alike: 60
/// in all, most of them where the level decides; three sets of 11 where there is one level.
std::vector<WindCase> wind_cases(double sigma_mps, std::size_t levels);

}  // namespace pilotage
