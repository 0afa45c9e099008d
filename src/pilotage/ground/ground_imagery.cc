#include "pilotage/ground/ground_imagery.h"

#include <algorithm>
#include <cmath>

#include "pilotage/raster/gdal_io.h"

namespace pilotage {

std::vector<std::string> dataset_names(const Imagery& imagery) {
  std::vector<std::string> names;
  for (const ImageryDataset& raster : imagery.datasets) names.push_back(raster.dataset);
  return names;
}

GraySource open_gray(const Ground& ground, const GridLevel& level) {
  const Imagery& imagery = ground.imagery;
  if (imagery.own_grid) return open_gray(imagery.datasets.front().dataset, imagery.options);
  return open_gray_on_grid(dataset_names(imagery), ground.crs, level.matrix.map_from_pixel, level.matrix.grid_width_px,
                           level.matrix.grid_height_px, imagery.options);
}

GroundImagery open_imagery(const Ground& ground) {
  const Imagery& imagery = ground.imagery;
  GroundImagery opened;
  for (const GridLevel& level : ground.levels) {
    const TileMatrix& matrix = level.matrix;
    if (imagery.own_grid) {
      opened.levels.push_back(
          {open_gray(ground, level), open_colors(imagery.datasets.front().dataset, imagery.options), 0});
    } else {
      opened.levels.push_back(open_gray_and_colors_on_grid(dataset_names(imagery), ground.crs, matrix.map_from_pixel,
                                                           matrix.grid_width_px, matrix.grid_height_px, imagery.options,
                                                           kImageryBytes / std::ssize(ground.levels)));
    }
  }
  return opened;
}

Raster read_overview(const Ground& ground, int max_side_px) {
  Bounds bounds;
  const double finest_m = ground.levels.front().gsd_m;
  for (const GroundTile& tile : ground.tiles) {
    bounds.extend({tile.bounds.min_x_m, tile.bounds.min_y_m});
    bounds.extend({tile.bounds.max_x_m, tile.bounds.max_y_m});
  }
  const double pixel_m = std::max(finest_m, std::max(bounds.width_m(), bounds.height_m()) / max_side_px);
  const int width_px = std::max(1, static_cast<int>(std::ceil(bounds.width_m() / pixel_m - 1e-9)));
  const int height_px = std::max(1, static_cast<int>(std::ceil(bounds.height_m() / pixel_m - 1e-9)));
  return read_rgb8_on_grid(dataset_names(ground.imagery), ground.crs,
                           GeoTransform::north_up(bounds.min_x_m, bounds.max_y_m, pixel_m), width_px, height_px,
                           ground.imagery.options);
}

}  // namespace pilotage
