#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pilotage/camera/attitude.h"
#include "pilotage/camera/camera.h"
#include "pilotage/camera/terrain_heights.h"
#include "pilotage/geo/geodetic_point.h"
#include "pilotage/raster/gdal_crs.h"
#include "pilotage/raster/gray_source.h"

namespace pilotage {

/// Where an aircraft hangs over a ground grid, and what one metre is there. Pixels (column, row) of the ground, centres
/// at +0.5.
struct GroundPlace {
  Eigen::Vector2d nadir_px{0, 0};  ///< The point straight below the camera.
  /// Pixels of the ground per metre to the true east (first column) and to the true north (second column): holds pixel
  /// size, unit, scale and convergence of the ground's CRS.
  Eigen::Matrix2d pixel_from_enu_m = Eigen::Matrix2d::Identity();

  Eigen::Vector2d pixel_from_ground(const Eigen::Vector2d& ground_m) const {
    return nadir_px + pixel_from_enu_m * ground_m;
  }
};

/// The place of `nadir_px` on a grid of any CRS (metres, feet, degrees, EPSG:3857), rotated or not. The Jacobian is
/// taken by differences on the ellipsoid (geo/enu_from_grid.h); what it leaves out is the change of scale and
/// convergence within a frame: below 1 cm over a footprint of 150 m in any of the usual projections up to 60° latitude.
/// Throws DataError where the grid has no longitude and latitude.
GroundPlace ground_place(const Crs& crs, const GeoTransform& map_from_pixel, const Eigen::Vector2d& nadir_px);
/// The same with the transform of the ground's CRS, for many places of one ground.
GroundPlace ground_place(const CrsTransform& transform, const GeoTransform& map_from_pixel,
                         const Eigen::Vector2d& nadir_px);

/// Longitude and latitude of a pixel position. Throws DataError where there is none.
GeodeticPoint geodetic_from_pixel(const CrsTransform& transform, const GeoTransform& map_from_pixel,
                                  const Eigen::Vector2d& pixel);

struct RenderedFrame {
  cv::Mat gray;               ///< CV_8UC1 of the camera's size; 0 where not valid.
  cv::Mat valid;              ///< CV_8UC1: 255 where all the ground that the pixel sees is valid, else 0.
  double valid_fraction = 0;  ///< Share of the frame that is.
};

/// The rays of the corners of a camera's pixels, row by row, (width + 1) × (height + 1), in its own frame; NaN outside
/// the lens's domain. To bend them straight is most of the work of a frame: for many frames of one camera they are
/// worked out once. Throws DataError when the camera has a problem.
std::vector<Eigen::Vector3d> corner_rays(const Camera& camera);

/// What a camera sees of flat ground with the gray values of `ground`: the inverse of ortho_rectify, by the same
/// projection (camera/projection.h). Each pixel of the frame is the mean over the quadrilateral that it covers
/// (camera/sampled_ground.h). Only the window of `ground` under the footprint is read. Throws UsageError when no View
/// can be made of camera, attitude and `agl_m`, when `ground` is not CV_8U (stretch_to_8bit makes it so), or when the
/// footprint holds more than 2^28 of its pixels; DataError as ground.read.
RenderedFrame render_frame(const GraySource& ground, const GroundPlace& place, const Camera& camera,
                           const Attitude& attitude, double agl_m, const std::vector<Eigen::Vector3d>* rays = nullptr);

/// The same of ground that is not flat: each corner of a pixel lies where its ray first meets `terrain`
/// (terrain_from_pixel), whose heights are above the ground straight below, as `agl_m` is of the camera. A pixel whose
/// corners lie before and behind a ridge is the mean of all between. Where heights are not known nothing is valid.
/// Throws as render_frame.
RenderedFrame render_terrain_frame(const GraySource& ground, const GroundPlace& place, const Camera& camera,
                                   const Attitude& attitude, double agl_m, const TerrainHeights& terrain,
                                   const std::vector<Eigen::Vector3d>* rays = nullptr);

/// Whether the outline of the footprint lies inside the grid of `ground` and no part of the frame shows the sky: what
/// render_frame would need to be valid everywhere, but for holes in the imagery. Reads nothing.
bool footprint_inside(const GraySource& ground, const GroundPlace& place, const Camera& camera,
                      const Attitude& attitude, double agl_m);

}  // namespace pilotage
