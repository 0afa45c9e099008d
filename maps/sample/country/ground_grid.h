#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "country/waters.h"

namespace pilotage::scene_detail {

/// What changes slowly over the ground, known at the nodes of a grid and bilinear between them.
struct GroundNode {
  float elevation_m = 0;
  float lake_m = 0;    ///< Signed distance to the lake's shore, positive inside.
  float water_m = 0;   ///< The same to the nearest water.
  float bend_x_m = 0;  ///< What bends straight parcel edges into slightly curved ones.
  float bend_y_m = 0;
  float soil = 0;                   ///< Patches of soil, about −1 … 1, wavelength 110 m.
  float stand = 0;                  ///< Patches in woods and meadows, wavelength 60 m.
  std::array<float, 2> sunlight{};  ///< Hill shading at each date, 1 on level ground.
};

/// Nodes every kSpacing_m over the scene and kMargin_m around it.
struct GroundGrid {
  static constexpr double kSpacing_m = 8;
  static constexpr double kMargin_m = 400;
  int columns = 0;
  int rows = 0;
  std::vector<GroundNode> nodes;

  /// Bilinear; outside the grid the values of its edge.
  GroundNode at(const Eigen::Vector2d& p) const;
};

GroundGrid make_ground(std::uint64_t seed, const Waters& waters);

/// Where the bend carries a point: parcels, roads and streets are drawn in these coordinates.
Eigen::Vector2d bent_from_ground(const GroundGrid& ground, const Eigen::Vector2d& p);

/// The inverse of bent_from_ground, by fixed-point iteration, to 1e-6 m.
Eigen::Vector2d ground_from_bent(const GroundGrid& ground, const Eigen::Vector2d& q);

}  // namespace pilotage::scene_detail
