#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "country/colour.h"
#include "country/epoch.h"
#include "country/ground_grid.h"
#include "country/land_cover.h"
#include "country/parcels.h"

namespace pilotage::scene_detail {

/// A point of the ground with all that its colour depends on.
struct GroundPoint {
  Eigen::Vector2d p;  ///< On the ground, metres east and north of the scene's south-west corner.
  Eigen::Vector2d q;  ///< Bent: parcels and roads are straight here.
  GroundNode node;
  const Parcel* parcel = nullptr;
  const ParcelEdge* edge = nullptr;  ///< The one whose strip or road is nearest.
  double edge_m = 0;                 ///< Distance to its axis.
  double footprint_m = 0;            ///< Side of the pixel.
  SceneEpoch epoch = SceneEpoch::kFirst;
  std::uint64_t seed = 0;        ///< For what both dates share.
  std::uint64_t fresh_seed = 0;  ///< For what is drawn anew at each date.
};

/// What a point shows before the hill's light and the shadows of other things.
struct Surface {
  Rgb colour;
  LandCover cover = LandCover::kField;
  float light = 1;     ///< Its own shading: crowns, roof sides.
  float height_m = 0;  ///< Above the ground: what is lower than a shadow's edge is in the shadow.
};

Surface field_surface(const GroundPoint& at);
Surface meadow_surface(const GroundPoint& at);
Surface strip_surface(const GroundPoint& at);  ///< Grass between parcels, with what grows in a hedge.
Surface pit_surface(const GroundPoint& at);
Surface farmyard_surface(const GroundPoint& at);
Surface orchard_surface(const GroundPoint& at);
Surface forest_surface(const GroundPoint& at);
Surface road_surface(const GroundPoint& at);  ///< Roads, streets with footways, tracks: by at.edge.
Surface garden_surface(const GroundPoint& at);
Surface works_surface(const GroundPoint& at);
Surface water_surface(const GroundPoint& at, float depth_m);
Surface bank_surface(const GroundPoint& at, float depth_m);

/// Where a wood leaves a glade; a meadow grows there.
bool is_clearing(const GroundPoint& at);

/// Grass of a given tone with blades, tufts and paler patches.
Rgb grass_colour(const GroundPoint& at, const Rgb& tone, float patchiness);

/// The orchard lattice: metres between rows, and between the trees of a row.
constexpr double kOrchardRow_m = 5.0;
constexpr double kOrchardTree_m = 4.0;

/// A dome-shaped crown seen from above; `offset` from its middle in radii (norm <= 1).
float crown_light(const Eigen::Vector2d& offset, const EpochLook& look);

}  // namespace pilotage::scene_detail
