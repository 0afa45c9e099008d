#pragma once

#include <functional>
#include <string>

#include <Eigen/Core>

#include "pilotage/geo/bounds.h"
#include "pilotage/geo/geodetic_point.h"
#include "pilotage/raster/raster.h"

namespace pilotage {

/// The plane of EPSG:3857 (spherical Mercator, R = 6,378,137 m), in which Leaflet draws.
inline constexpr double kMercatorMaxLat_deg = 85.0;

/// Coordinates in that plane. x is continuous in lon_deg, also beyond ±180. NaN where |lat_deg| exceeds
/// kMercatorMaxLat_deg.
Eigen::Vector2d mercator_from_geodetic(GeodeticPoint point);

/// From coordinates of the mission grid to the plane. Longitudes are unwrapped around `reference_lon_deg`, so that a
/// corridor across the antimeridian stays in one piece. NaN where the point has no image.
std::function<Eigen::Vector2d(const Eigen::Vector2d&)> mercator_from_map(
    std::function<GeodeticPoint(Eigen::Vector2d)> geodetic_from_map, double reference_lon_deg);

/// A north-up picture in the plane: square pixels of side pixel_m.
struct DisplayGrid {
  Bounds edges_m;
  double pixel_m = 1;
  int width_px = 0;
  int height_px = 0;
};

/// The grid over `bounds_m` with `longer_side_px` pixels on its longer side; its edges are whole pixels around the same
/// centre. The shorter side has at least one pixel. `bounds_m` has a positive width or height.
DisplayGrid display_grid(const Bounds& bounds_m, int longer_side_px);

/// The mission grid's coordinates of every pixel centre of `grid`, as CV_64FC2; NaN where there are none.
/// `display_from_map` is inverted by Newton's method on a lattice, starting at `start`, and interpolated between its
/// nodes; the lattice is halved until the interpolation is right to 0.25 pixels at the middle of every cell (or has a
/// node every 8 pixels).
cv::Mat map_from_display(const DisplayGrid& grid,
                         const std::function<Eigen::Vector2d(const Eigen::Vector2d&)>& display_from_map,
                         const Eigen::Vector2d& start);

/// The imagery resampled into a picture, red-green-blue CV_8UC3: bilinear, or the mean over the covered pixels where
/// the picture is coarser. Pixels without imagery are the gray of the map's background.
cv::Mat warp_imagery(const Raster& imagery, const cv::Mat& map_xy);

/// Baseline JPEG of a red-green-blue or gray picture with the best quality of 88, 80, 70, 60, 45, 30 that keeps it
/// within `max_bytes` (the last when none does). Throws DataError when the encoder refuses.
std::string encode_jpeg(const cv::Mat& picture, std::size_t max_bytes);

/// PNG of a picture of red, green, blue and, with four channels, opacity. Throws DataError when the encoder refuses.
std::string encode_png(const cv::Mat& picture);

}  // namespace pilotage
