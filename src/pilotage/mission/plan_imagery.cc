#include "pilotage/mission/plan_imagery.h"

#include <algorithm>
#include <cmath>

#include "pilotage/raster/gdal_io.h"

namespace pilotage {

std::vector<std::string> dataset_names(const TilePlan& plan) {
  std::vector<std::string> names;
  for (const PlanImagery& imagery : plan.imagery) names.push_back(imagery.dataset);
  return names;
}

GraySource open_plan_imagery(const TilePlan& plan, const PlanLevel& level) {
  return open_gray_on_grid(dataset_names(plan), Crs::from_user_input(plan.crs_wkt), level.matrix.map_from_pixel,
                           level.matrix.grid_width_px, level.matrix.grid_height_px, plan.imagery_options);
}

ColorSource open_plan_colors(const TilePlan& plan, const PlanLevel& level) {
  return open_colors_on_grid(dataset_names(plan), Crs::from_user_input(plan.crs_wkt), level.matrix.map_from_pixel,
                             level.matrix.grid_width_px, level.matrix.grid_height_px, plan.imagery_options);
}

Raster read_plan_overview(const TilePlan& plan, int max_side_px) {
  Bounds bounds;
  const double finest_m = plan.levels.front().gsd_m;
  for (const PlanTile& tile : plan.tiles) {
    bounds.extend({tile.bounds.min_x_m, tile.bounds.min_y_m});
    bounds.extend({tile.bounds.max_x_m, tile.bounds.max_y_m});
  }
  const double pixel_m = std::max(finest_m, std::max(bounds.width_m(), bounds.height_m()) / max_side_px);
  const int width_px = std::max(1, static_cast<int>(std::ceil(bounds.width_m() / pixel_m - 1e-9)));
  const int height_px = std::max(1, static_cast<int>(std::ceil(bounds.height_m() / pixel_m - 1e-9)));
  return read_rgb8_on_grid(dataset_names(plan), Crs::from_user_input(plan.crs_wkt),
                           GeoTransform::north_up(bounds.min_x_m, bounds.max_y_m, pixel_m), width_px, height_px,
                           plan.imagery_options);
}

}  // namespace pilotage
