#pragma once

#include <filesystem>

#include <opencv2/core/mat.hpp>

#include "pilotage/camera/attitude.h"
#include "pilotage/camera/camera.h"
#include "pilotage/camera/render_frame.h"
#include "pilotage/geo/geodetic_point.h"
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
};

TexturedGround make_textured_ground(int tiles = 3);

/// Writes a map of it: all its tiles with all their features and chips, as `pilotage build` would.
void write_textured_map(const std::filesystem::path& path, const TexturedGround& ground,
                        const FeatureOptions& features = {});

/// What the camera sees from `east_m`, `north_m` of the centre.
RenderedFrame frame_over(const TexturedGround& ground, double east_m, double north_m, const Attitude& attitude,
                         double agl_m);

}  // namespace pilotage::testing
