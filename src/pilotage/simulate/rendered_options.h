#pragma once

#include <string>
#include <vector>

#include "pilotage/base/options.h"
#include "pilotage/match/match.h"

namespace pilotage {

/// What is drawn of each flight with rendered fixes, and what the matcher is told. Errors are one standard deviation.
struct RenderedOptions {
  std::string world;
  std::string world_elevation;
  std::string map;
  std::vector<std::string> also_map;
  int frame_width_px = 640;
  double tilt_sigma_deg = 2;
  double boresight_sigma_deg = 0.3;
  double altimeter_sigma = 0.02;
  double exposure_ms = 2;
  double degradation = 1;
  double correct_within_m = 5;
  MatchOptions match;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.path(
        "world", self.world,
        "With rendered fixes: the ground that frames show, a raster of another date. Default: the mission's own "
        "imagery, changed as `score` changes it.");
    fields.path(
        "world_elevation", self.world_elevation,
        "With rendered fixes: the heights of the ground that frames show, an elevation model; the height of the line "
        "above sea level stays as planned. Default: the mission's own heights, which are those of the map.");
    fields.path("map", self.map, "With rendered fixes: the map; default map.gpkg beside the plan.");
    fields.path(
        "also_map", self.also_map,
        "With rendered fixes: another map of the ground, such as one of imagery of another date; each is asked. "
        "Repeat for more.");
    fields.field("frame_width_px", self.frame_width_px,
                 "Frames are rendered so wide, or as wide as the mission's camera if that is less.", Range{16, 10000});
    fields.field("tilt_sigma_deg", self.tilt_sigma_deg, "How far the aircraft rolls and pitches, anew for each frame.",
                 Range{0, 20});
    fields.field("boresight_sigma_deg", self.boresight_sigma_deg,
                 "Error of the camera's mount about each axis, one for a flight.", Range{0, 10});
    fields.field("altimeter_sigma", self.altimeter_sigma,
                 "Error of the height above ground that the matcher is told, as a share of it, one for a flight.",
                 Range{0, 0.3});
    fields.field("exposure_ms", self.exposure_ms, "Frames are blurred by the way flown meanwhile.", Range{0, 1000});
    fields.field("degradation", self.degradation,
                 "How much the mission's own imagery is changed, in units of the defaults of `score`; 0: not at all.",
                 Range{0, 1.5});
    fields.field("correct_within_m", self.correct_within_m, "A fix with a larger error is false.", Range{0.001, 1e6});
    fields.group("match", self.match, "What the matcher of rendered fixes is told.");
  }
};

}  // namespace pilotage
