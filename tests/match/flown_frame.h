#pragma once

#include <filesystem>

#include "testing/temporary_folder.h"
#include "testing/textured_map.h"
#include <opencv2/core.hpp>

#include "pilotage/geo/local_frame.h"
#include "pilotage/match/frame_on_grid.h"
#include "pilotage/match/local_map.h"
#include "pilotage/match/match.h"

namespace pilotage::testing {

/// Along the ground, over some kilometres at most.
inline double metres_between(const GeodeticPoint& a, const GeodeticPoint& b) {
  return LocalFrame(a).enu_from_geodetic(b).head<2>().norm();
}

/// A map of texture and a frame taken over it, as far as match() has them when it begins. The aircraft is 7 m east and
/// 11 m south of the centre, 60 m up; the prior is 6 m east and 8 m south of it.
struct FlownFrame {
  explicit FlownFrame(const Attitude& attitude = {30, 0, 0}) {
    path = folder / "map.gpkg";
    write_textured_map(path, ground);
    gray = frame_over(ground, kEast_m, kNorth_m, attitude, ground.agl_m).gray;
    prior.position = place(kEast_m + 6, kNorth_m - 8);
    prior.covariance_en_m2 = isotropic_covariance_m2(10);
    prior.height_agl_m = ground.agl_m;
    prior.attitude = attitude;
  }

  GeodeticPoint place(double east_m, double north_m) const {
    return LocalFrame(ground.center).geodetic_from_enu({east_m, north_m, 0});
  }
  FrameOnGrid rectify(MapReader& map) const { return rectify_frame(gray, prior, ground.camera, map, options); }
  LocalMap local_map(MapReader& map, const FrameOnGrid& rectified, const PivotedFrame& described) const {
    return read_local_map(map, *rectified.level, rectified.grid,
                          rectified.prior_px + rectified.px_from_m(rectified.pivot_m),
                          rectified.half_width_px + described.radius_px);
  }

  static constexpr double kEast_m = 7;
  static constexpr double kNorth_m = -11;
  TemporaryFolder folder;
  TexturedGround ground = make_textured_ground();
  std::filesystem::path path;
  cv::Mat gray;
  MatchPrior prior;
  MatchOptions options;
};

}  // namespace pilotage::testing
