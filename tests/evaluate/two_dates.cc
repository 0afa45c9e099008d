#include "evaluate/two_dates.h"

#include <opencv2/core.hpp>

#include "country/synthetic_scene.h"
#include "pilotage/raster/gdal_io.h"
#include "pilotage/raster/gray_stretch.h"

namespace pilotage::testing {
namespace {

constexpr double kGsd_m = 0.5;
constexpr int kSidePx = 480;

TileRow row_of(const TileMatrix& matrix, std::int64_t column, std::int64_t row, const GraySource& source,
               const CrsTransform& transform) {
  const PixelWindow window = matrix.tile_window(column, row);
  TileRow made;
  made.tile.tile_id = made.score.tile_id = row * matrix.matrix_width() + column;
  made.tile.column = made.score.column = column;
  made.tile.row = made.score.row = row;
  made.min_col_px = window.col;
  made.min_row_px = window.row;
  const Eigen::Vector2d first(static_cast<double>(window.col), static_cast<double>(window.row));
  made.tile.bounds.extend(matrix.map_from_pixel.map_from_pixel(first));
  made.tile.bounds.extend(
      matrix.map_from_pixel.map_from_pixel(first + Eigen::Vector2d(matrix.tile_size_px, matrix.tile_size_px)));
  made.tile.center = *transform.geodetic_from_map(made.tile.bounds.center_m());
  made.tile.valid_fraction = made.score.valid_fraction = 1;
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(source.read(window).pixels, mean, deviation);
  made.score.gray_variance = deviation[0];
  made.score.p_correct_fix = std::min(1.0, deviation[0] / 40);
  return made;
}

}  // namespace

TwoDates make_two_dates(const std::filesystem::path& folder) {
  const Scene scene = make_scene({});
  const Eigen::Vector2d corner = scene.map_from_local({scene.sites.town.x(), scene.sites.town.y() + 120});
  const GeoTransform grid = GeoTransform::north_up(corner.x(), corner.y(), kGsd_m);
  TwoDates made;
  made.reference = (folder / "reference.tif").string();
  made.other = (folder / "other.tif").string();
  made.moved = (folder / "moved.tif").string();
  write_rgb8_geotiff(made.reference, render_rgb8(scene, SceneEpoch::kFirst, grid, kSidePx, kSidePx), scene.crs());
  Raster later = render_rgb8(scene, SceneEpoch::kSecond, grid, kSidePx, kSidePx);
  write_rgb8_geotiff(made.other, later, scene.crs());
  later.map_from_pixel.origin_x += kMoved_m;
  write_rgb8_geotiff(made.moved, later, scene.crs());

  made.ground.crs = Crs::from_user_input(scene.crs());
  made.ground.matrix = {0, grid, kSidePx, kSidePx, 96, 48};
  made.ground.search_radius_px = 40;
  made.ground.datasets = {made.reference};
  const GraySource source = open_gray(made.reference);
  const CrsTransform transform(made.ground.crs);
  for (std::int64_t row = 0; row < made.ground.matrix.matrix_height(); ++row) {
    for (std::int64_t column = 0; column < made.ground.matrix.matrix_width(); ++column) {
      made.ground.rows.push_back(row_of(made.ground.matrix, column, row, source, transform));
    }
  }
  return made;
}

}  // namespace pilotage::testing
