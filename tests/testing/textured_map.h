#pragma once

#include <filesystem>
#include <functional>
#include <optional>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pilotage/camera/attitude.h"
#include "pilotage/camera/camera.h"
#include "pilotage/camera/projection.h"
#include "pilotage/camera/render_frame.h"
#include "pilotage/camera/terrain_heights.h"
#include "pilotage/geo/geodetic_point.h"
#include "pilotage/mapdb/map_landmarks.h"
#include "pilotage/raster/gray_source.h"
#include "pilotage/vision/features.h"

namespace pilotage::testing {

/// Ground of random texture at 0.5 m per pixel on UTM, of which a map and frames are made in milliseconds.
struct TexturedGround {
  int tiles = 3;  ///< Along each side, of 64 m.
  GraySource gray;
  Crs crs;
  GeodeticPoint center;
  Camera camera;     ///< 160 × 120 px, 69 m wide from agl_m.
  double agl_m = 0;  ///< The height that the map's one level is for.
  /// Of the ground, at metres east and north of the centre; without it the ground is level and the map has no heights.
  std::function<double(const Eigen::Vector2d&)> height_m;
  std::optional<double> elevation_sigma_m;  ///< What the map says of its heights.
  std::optional<double> map_sigma_m;        ///< What it says of its own error.
  std::optional<MapLandmarks> landmarks;    ///< What it holds of them.
  bool only_first_tile = false;             ///< The map stores the tile in the north-west alone.
};

TexturedGround make_textured_ground(int tiles = 3);

/// Writes a map of it: all its tiles with all their features and chips ("gray8"), as `pilotage build` would.
void write_textured_map(const std::filesystem::path& path, const TexturedGround& ground,
                        const FeatureOptions& features = {});

/// The heights that the camera may see from `nadir_m` east and north of the centre; `height_m` must be given.
TerrainHeights terrain_below(const TexturedGround& ground, const Eigen::Vector2d& nadir_m, const View& view);

/// What the camera sees from `east_m`, `north_m` of the centre, `agl_m` above the ground there.
RenderedFrame frame_over(const TexturedGround& ground, double east_m, double north_m, const Attitude& attitude,
                         double agl_m);

}  // namespace pilotage::testing
