#pragma once

#include <cstdint>

#include "country/ground_grid.h"
#include "country/land_use.h"
#include "country/objects.h"
#include "country/parcels.h"
#include "country/scene_options.h"
#include "country/surface.h"
#include "country/waters.h"

namespace pilotage::scene_detail {

/// All parts of a scene, in metres from its south-west corner.
struct World {
  std::uint64_t seed = 0;
  double width_m = 0;
  double height_m = 0;
  SceneSites sites;
  Waters waters;
  GroundGrid ground;
  Parcels parcels;
  ObjectIndex objects;
};

World make_world(const SceneOptions& options);

/// A point of the world at a date, with all its light: the colour on the 0 … 255 scale before the camera.
struct Sight {
  Rgb colour;
  LandCover cover = LandCover::kField;
};

/// What is seen at `p` in pixels of side `footprint_m`.
Sight look_at(const World& world, SceneEpoch epoch, const Eigen::Vector2d& p, double footprint_m);

}  // namespace pilotage::scene_detail
