#pragma once

#include <Eigen/Core>

#pragma GCC visibility push(default)

namespace pilotage {

/// The affine map from pixels to CRS coordinates, as GDAL orders it. Pixel coordinates: (0, 0) is the outer corner of
/// the first pixel, whose centre is (0.5, 0.5); x = column to the right, y = row downwards. CRS coordinates: x =
/// easting or longitude first, y = northing or latitude, whatever the authority's axis order.
///   x_map = origin_x + col·x_per_col + row·x_per_row
///   y_map = origin_y + col·y_per_col + row·y_per_row
struct GeoTransform {
  double origin_x = 0;
  double x_per_col = 1;
  double x_per_row = 0;
  double origin_y = 0;
  double y_per_col = 0;
  double y_per_row = -1;

  /// A north-up grid of square pixels of side `gsd` whose outer top-left corner is (`min_x`, `max_y`).
  static GeoTransform north_up(double min_x, double max_y, double gsd) { return {min_x, gsd, 0, max_y, 0, -gsd}; }

  Eigen::Vector2d map_from_pixel(const Eigen::Vector2d& pixel) const {
    return {origin_x + pixel.x() * x_per_col + pixel.y() * x_per_row,
            origin_y + pixel.x() * y_per_col + pixel.y() * y_per_row};
  }

  /// Units of the CRS squared that one pixel covers; 0 when the transform cannot be inverted.
  double determinant() const { return x_per_col * y_per_row - x_per_row * y_per_col; }

  /// The inverse of map_from_pixel; the determinant must not be 0.
  Eigen::Vector2d pixel_from_map(const Eigen::Vector2d& point) const {
    const double dx = point.x() - origin_x;
    const double dy = point.y() - origin_y;
    const double d = determinant();
    return {(y_per_row * dx - x_per_row * dy) / d, (x_per_col * dy - y_per_col * dx) / d};
  }

  /// The transform of the sub-grid whose first pixel is (`col`, `row`) of this one.
  GeoTransform shifted(double col, double row) const {
    GeoTransform result = *this;
    const Eigen::Vector2d origin = map_from_pixel({col, row});
    result.origin_x = origin.x();
    result.origin_y = origin.y();
    return result;
  }

  bool operator==(const GeoTransform&) const = default;
};

}  // namespace pilotage

#pragma GCC visibility pop
