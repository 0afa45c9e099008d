#pragma once

#include "country/settlement.h"

namespace pilotage::scene_detail {

/// Trees and bushes of the hedges, trees along roads, and single trees of a meadow, for one parcel. Edges are planted
/// from the side whose normal points east, so that none is planted twice.
void plant_parcel(const GroundGrid& ground, const Parcels& parcels, const Parcel& parcel, Stands& stands);

/// Alders and willows along the river and the lake.
void plant_banks(std::uint64_t seed, const GroundGrid& ground, double width_m, double height_m, Stands& stands);

/// Vehicles on the roads around a parcel, others at each date.
void drive_roads(const GroundGrid& ground, const Parcels& parcels, const Parcel& parcel, Stands& stands);

/// A farm of barns around a yard; `q` is its middle in bent coordinates.
void build_farm(std::uint64_t seed, const GroundGrid& ground, const Eigen::Vector2d& q,
                const Eigen::Vector2d& direction, Stands& stands);

}  // namespace pilotage::scene_detail
