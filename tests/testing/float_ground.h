#pragma once

#include <cmath>
#include <limits>
#include <string>

#include "testing/temporary_folder.h"
#include <opencv2/core.hpp>

#include "pilotage/base/random.h"
#include "pilotage/raster/gdal_write.h"

namespace pilotage::testing {

/// Ground of floats with a hole in it, as a GeoTIFF. Floats: the result then depends on samples of the whole raster,
/// which every shard must take alike.
inline std::string write_float_ground(const TemporaryFolder& folder, int rows, int cols) {
  Random random(seed_from_name("float ground"));
  cv::Mat values(rows, cols, CV_32F);
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) {
      values.at<float>(row, col) = static_cast<float>(
          500 + 80 * std::sin(0.07 * row) * std::cos(0.05 * col + 0.02 * row) + 30 * random.normal());
    }
  }
  values(cv::Rect(cols / 2, rows / 3, cols / 4, rows / 2)).setTo(std::numeric_limits<float>::quiet_NaN());
  const std::string file = folder.path() / "ground.tif";
  write_score_raster(file, {{"gray", "", values}}, Crs::from_user_input("EPSG:32633"),
                     GeoTransform::north_up(500000, 5000000, 0.5), false);
  return file;
}

}  // namespace pilotage::testing
