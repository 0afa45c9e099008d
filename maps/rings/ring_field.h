#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "rasterise.h"
#include "ring_scene.h"

#include "pilotage/geo/geodetic_point.h"
#include "pilotage/raster/raster.h"

namespace pilotage {

/// The ground under the rings: a square of the sample mission's country at its first date, with grain where that is
/// smooth, for it is made for frames from 120 m. A picture of exactly known place; what flies gets a map made of it.
struct RingField {
  Raster rgb;
  std::string crs;
  GeodeticPoint middle;  ///< East = north = 0.
  GroundPicture picture;
};

struct RingFieldOptions {
  double side_m = 110;
  double gsd_m = 0.05;
};

RingField make_ring_field(const RingFieldOptions& options, int threads);

/// Prepares the field for flights at `low_m` to `high_m` above it as `pilotage prepare` does, with `camera`, which
/// looks straight down, and leaves map.gpkg and the other outputs in `folder`. Returns the map's path. Throws as
/// prepare().
std::filesystem::path prepare_ring_field(const RingField& field, const Camera& camera, double low_m, double high_m,
                                         const std::filesystem::path& folder, int threads);

/// The rings, their posts and the decoys as triangles.
Mesh mesh_of(const RingScene& scene);

}  // namespace pilotage
