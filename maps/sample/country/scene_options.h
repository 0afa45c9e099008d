#pragma once

#include <cstdint>

#include "pilotage/base/options.h"

namespace pilotage {

/// What world `make_scene` makes. The same options give the same world, bit for bit.
struct SceneOptions {
  std::int64_t seed = 1;
  double width_m = 3000;
  double height_m = 2000;
  double center_lon_deg = 16.5;
  double center_lat_deg = 55.5;
  int landmarks = 0;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("seed", self.seed, "Seed of everything random in the scene.", Range{0, 9007199254740992});
    fields.field("width_m", self.width_m, "Extent from west to east.", Range{2000, 20000});
    fields.field("height_m", self.height_m, "Extent from south to north.", Range{1500, 20000});
    fields.field("center_lon_deg", self.center_lon_deg, "Longitude of the centre.", Range{-180, 180});
    fields.field("center_lat_deg", self.center_lat_deg, "Latitude of the centre.", Range{-79, 83});
    fields.field("landmarks", self.landmarks,
                 "Round landmarks of each class (tanks, roundabouts, rings) on open ground, as far as there is room.",
                 Range{0, 1000});
  }
};

}  // namespace pilotage
