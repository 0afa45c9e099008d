#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "country/epoch.h"
#include "country/land_cover.h"
#include "country/land_use.h"
#include "country/scene_options.h"
#include "pilotage/geo/geo_transform.h"
#include "pilotage/geo/geodetic_point.h"
#include "pilotage/raster/raster.h"

namespace pilotage {

namespace scene_detail {
struct World;
}

/// A fictitious piece of country: hills, a river and a lake, a town, fields, orchards, woods and roads, at two dates.
/// It is a function of the ground, not a picture: any window, any pixel size and any affine view can be rendered, and
/// what lies where is known exactly. Coordinates are metres of a UTM zone of WGS 84.
struct Scene {
  SceneOptions options;
  int epsg = 0;                                      ///< Of the UTM zone: 32601 … 32660 north, 32701 … 32760 south.
  Eigen::Vector2d origin_m;                          ///< South-west corner in the CRS, whole tens of metres.
  SceneSites sites;                                  ///< Metres from the south-west corner.
  std::shared_ptr<const scene_detail::World> world;  ///< Immutable, shared by copies.

  /// "EPSG:32633".
  std::string crs() const;
  Eigen::Vector2d map_from_local(const Eigen::Vector2d& local_m) const { return origin_m + local_m; }
};

/// Deterministic in `options`. Throws UsageError when an option is outside its range.
Scene make_scene(const SceneOptions& options);

/// North-up pixels of side `gsd_m` over the whole scene, first pixel at its north-west corner.
GeoTransform whole_scene_grid(const Scene& scene, double gsd_m);

/// The scene as a camera that looks straight down shows it at a date: 8-bit RGB, pixels outside the scene not valid.
/// Each pixel is a weighted mean of the scene over and around it (weights 1/2 in the middle, 1/8 at each corner, of 2^k
/// × 2^k parts of the pixel when it is larger than 0.75 m); a pixel depends on its place alone. So the picture is the
/// same for any number of threads, and windows are parts of the whole bit for bit where the grid's coordinates are
/// exact in binary (origin and pixel size multiples of a power of two); otherwise rounding of coordinates may move a
/// gray value by 1 here and there. Throws UsageError when the transform cannot be inverted, is not finite, or the size
/// is not positive.
Raster render_rgb8(const Scene& scene, SceneEpoch epoch, const GeoTransform& map_from_pixel, int width_px,
                   int height_px, int threads = 0);

/// Exact labels (CV_8U, values of LandCover) at pixel centres; 255 outside the scene.
cv::Mat land_cover(const Scene& scene, SceneEpoch epoch, const GeoTransform& map_from_pixel, int width_px,
                   int height_px, int threads = 0);

/// Height of the ground (without what stands on it) at pixel centres, CV_32F, metres; NaN outside the scene.
cv::Mat elevation(const Scene& scene, const GeoTransform& map_from_pixel, int width_px, int height_px);

/// A round landmark (SceneOptions::landmarks): "tank", "roundabout" or "ring".
struct SceneLandmark {
  std::string class_name;
  Eigen::Vector2d center_m;  ///< In the CRS.
  double diameter_m = 0;
};

/// All of them, exactly, the same at both dates.
std::vector<SceneLandmark> landmarks(const Scene& scene);

/// Direction of an orchard's rows at `local_m` as a unit vector on the ground; throws UsageError where no orchard is.
/// Rows are 5 m apart and trees 4 m apart along them, exactly.
Eigen::Vector2d orchard_rows(const Scene& scene, const Eigen::Vector2d& local_m);

}  // namespace pilotage
