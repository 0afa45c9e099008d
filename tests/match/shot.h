#pragma once

#include <filesystem>

#include "testing/temporary_folder.h"
#include "testing/textured_map.h"
#include <Eigen/Core>

#include "pilotage/base/nan.h"
#include "pilotage/camera/projection.h"
#include "pilotage/geo/local_frame.h"
#include "pilotage/match/match.h"

namespace pilotage::testing {

/// A map of texture.
struct ShotMap {
  explicit ShotMap(TexturedGround textured, const FeatureOptions& features = {}) : ground(std::move(textured)) {
    path = folder / "map.gpkg";
    write_textured_map(path, ground, features);
  }
  GeodeticPoint place(double east_m, double north_m) const {
    return LocalFrame(ground.center).geodetic_from_enu({east_m, north_m, 0});
  }

  TemporaryFolder folder;
  TexturedGround ground;  ///< What frames show.
  std::filesystem::path path;
};

/// Where the aircraft is, and what it believes.
struct Shot {
  double east_m = 0;
  double north_m = 0;
  Attitude attitude;
  double height_m = 60;   ///< Above the ground straight below.
  double focal_px = 140;  ///< 69 m wide
  CameraMount mount;
  Eigen::Vector2d prior_off_m{6, -8};
  Attitude attitude_off;
  double height_ratio = 1;  ///< Of the prior to the truth.
};

struct ShotAnswer {
  MatchResult result;
  Eigen::Vector2d error_m{kNaN, kNaN};         ///< Of position.
  Eigen::Vector2d center_error_m{kNaN, kNaN};  ///< Of the ground under the principal point.
};

inline MatchPrior prior_of(const ShotMap& map, const Shot& shot) {
  MatchPrior prior;
  prior.position = map.place(shot.east_m + shot.prior_off_m.x(), shot.north_m + shot.prior_off_m.y());
  prior.covariance_en_m2 = isotropic_covariance_m2(10);
  prior.height_agl_m = shot.height_m * shot.height_ratio;
  prior.attitude = {shot.attitude.yaw_deg + shot.attitude_off.yaw_deg,
                    shot.attitude.pitch_deg + shot.attitude_off.pitch_deg,
                    shot.attitude.roll_deg + shot.attitude_off.roll_deg};
  return prior;
}

inline ShotAnswer match_shot(const ShotMap& map, const Shot& shot, const MatchOptions& options = {}) {
  TexturedGround ground = map.ground;
  ground.camera.mount = shot.mount;
  ground.camera.fx_px = ground.camera.fy_px = shot.focal_px;
  const cv::Mat frame = frame_over(ground, shot.east_m, shot.north_m, shot.attitude, shot.height_m).gray;
  MapReader reader = MapReader::open_unverified(map.path);
  ShotAnswer answer;
  answer.result = match(frame, prior_of(map, shot), ground.camera, reader, options);
  if (!answer.result.fix) return answer;
  const LocalFrame enu(map.ground.center);
  const Eigen::Vector2d truth_m(shot.east_m, shot.north_m);
  const auto view = make_view(ground.camera, shot.attitude, shot.height_m);
  const Eigen::Vector2d principal_px(ground.camera.cx_px, ground.camera.cy_px);
  const Eigen::Vector2d center_m = ground.height_m
                                       ? *terrain_from_pixel(*view, terrain_below(ground, truth_m, *view), principal_px)
                                       : *ground_from_pixel(*view, principal_px);
  answer.error_m = enu.enu_from_geodetic(answer.result.fix->position).head<2>() - truth_m;
  answer.center_error_m = enu.enu_from_geodetic(answer.result.fix->center).head<2>() - truth_m - center_m;
  return answer;
}

}  // namespace pilotage::testing
