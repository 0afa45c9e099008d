#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "country/ground_grid.h"
#include "country/parcels.h"
#include "country/waters.h"

namespace pilotage {

/// Where the typical kinds of ground of a scene lie, in metres east and north of its south-west corner.
struct SceneSites {
  Eigen::Vector2d town;
  Eigen::Vector2d hamlet;
  Eigen::Vector2d lake;
  Eigen::Vector2d forest;
  Eigen::Vector2d orchard;
  Eigen::Vector2d fields;
  double town_radius_m = 0;
  double hamlet_radius_m = 0;
};

namespace scene_detail {

SceneSites make_sites(std::uint64_t seed, const Waters& waters);

/// True in the town or the hamlet, whose outlines are uneven.
bool in_settlement(std::uint64_t seed, const SceneSites& sites, const Eigen::Vector2d& p);

/// Gives every parcel its use and its crop, and moves the forest, orchard and field sites to the centre of such a
/// parcel.
void assign_land_use(std::uint64_t seed, const GroundGrid& ground, Parcels& parcels, SceneSites& sites);

}  // namespace scene_detail
}  // namespace pilotage
