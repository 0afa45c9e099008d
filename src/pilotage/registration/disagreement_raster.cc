#include "pilotage/registration/disagreement_raster.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <opencv2/core.hpp>

namespace pilotage {

DisagreementRaster disagreement_raster(const WarpField& field, const Bounds& area_m) {
  // A field of nothing has no cells; the layer then says so in a few pixels.
  const bool nothing = field.control_m.empty();
  const double pixel_m = nothing ? std::max({area_m.width_m(), area_m.height_m(), 1.0}) / 8 : field.cell_m;
  // Pixels are the field's cells, so that each is known as a whole or not.
  const double min_x_m = field.min_x_m + std::floor((area_m.min_x_m - field.min_x_m) / pixel_m) * pixel_m;
  const double max_y_m = field.min_y_m + std::ceil((area_m.max_y_m - field.min_y_m) / pixel_m) * pixel_m;
  const int columns = std::max(1, static_cast<int>(std::ceil((area_m.max_x_m - min_x_m) / pixel_m - 1e-9)));
  const int rows = std::max(1, static_cast<int>(std::ceil((max_y_m - area_m.min_y_m) / pixel_m - 1e-9)));
  DisagreementRaster raster;
  raster.map_from_pixel = GeoTransform::north_up(min_x_m, max_y_m, pixel_m);
  for (const char* name : {"east_m", "north_m", "magnitude_m", "sigma_m"}) {
    raster.bands.push_back({name, "m", cv::Mat(rows, columns, CV_32F)});
  }
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < columns; ++col) {
      const Eigen::Vector2d point = raster.map_from_pixel.map_from_pixel({col + 0.5, row + 0.5});
      const Eigen::Vector2d moved = field.displacement_m(point.x(), point.y());
      const double values[] = {moved.x(), moved.y(), moved.norm(), field.sigma_m(point.x(), point.y())};
      for (std::size_t band = 0; band < 4; ++band) {
        raster.bands[band].values.at<float>(row, col) = static_cast<float>(values[band]);
      }
    }
  }
  return raster;
}

}  // namespace pilotage
