#pragma once

#include <vector>

#include "country/ground_grid.h"
#include "country/objects.h"
#include "country/parcels.h"

namespace pilotage::scene_detail {

/// What stands in a scene.
struct Stands {
  std::vector<Box> boxes;
  std::vector<Tree> trees;
};

/// Houses with sheds and garden trees along the streets of a block of dwellings.
void build_dwellings(const GroundGrid& ground, const Parcels& parcels, const Parcel& block, Stands& stands);

/// Halls and car parks of a block of works.
void build_works(const GroundGrid& ground, const Parcels& parcels, const Parcel& block, Stands& stands);

/// Trees of a park.
void plant_park(const GroundGrid& ground, const Parcels& parcels, const Parcel& block, Stands& stands);

/// Least distance of a point in a parcel to what runs along the parcel's edges (negative on a road).
double clearance_m(const Parcels& parcels, const Parcel& parcel, const Eigen::Vector2d& q);

/// A car or lorry; `epochs` as in Box.
Box make_vehicle(std::uint64_t seed, const Eigen::Vector2d& center_m, const Eigen::Vector2d& along,
                 std::uint8_t epochs);

}  // namespace pilotage::scene_detail
