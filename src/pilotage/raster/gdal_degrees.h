#pragma once

#include <opencv2/core/mat.hpp>

#include "pilotage/geo/geo_transform.h"
#include "pilotage/raster/gdal_crs.h"

namespace pilotage {

/// A picture on a grid of degrees: what KML calls a ground overlay.
struct DegreePicture {
  cv::Mat rgba;  ///< CV_8UC4: red, green, blue, opacity; nothing is drawn where that is 0.
  double west_deg = 0;
  double south_deg = 0;
  double east_deg = 0;  ///< Greater than west_deg; across the antimeridian one of both lies beyond ±180.
  double north_deg = 0;
};

/// Draws `rgba` (CV_8UC4) of a projected CRS on a grid of WGS 84 degrees by nearest neighbour, each pixel about
/// `scale` times as wide; at most `max_side_px` pixels a side. Places are right to a tenth of a pixel of the result.
/// Throws DataError when PROJ knows no way.
DegreePicture picture_in_degrees(const cv::Mat& rgba, const Crs& crs, const GeoTransform& map_from_pixel, int scale,
                                 int max_side_px);

}  // namespace pilotage
