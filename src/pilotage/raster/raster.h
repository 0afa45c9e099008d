#pragma once

#include <opencv2/core/mat.hpp>

#include "pilotage/geo/geo_transform.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// Pixels with a place. `pixels` and `valid` have the same size.
struct Raster {
  /// One channel: gray values, CV_8U, CV_16U, CV_32F or CV_64F. Three channels: red, green, blue in this order,
  /// CV_8U, CV_16U or CV_64F.
  /// What stands in a pixel that is not valid is not defined.
  cv::Mat pixels;
  /// CV_8U: 255 where there is ground, 0 where there is no data.
  cv::Mat valid;
  /// From pixels of this raster to the CRS.
  GeoTransform map_from_pixel;
};

}  // namespace pilotage

#pragma GCC visibility pop
