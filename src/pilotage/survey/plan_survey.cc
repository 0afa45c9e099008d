#include "pilotage/survey/plan_survey.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/base/utc_time.h"
#include "pilotage/camera/camera_products.h"
#include "pilotage/camera/projection.h"
#include "pilotage/ground/ground_of_rasters.h"
#include "pilotage/raster/elevation.h"
#include "pilotage/raster/gdal_io.h"
#include "pilotage/raster/mission_crs.h"
#include "pilotage/tile/working_gsd.h"

namespace pilotage {
namespace {

std::vector<ImageryInfo> inspect_area(const std::vector<std::string>& imagery, const ImageryOptions& options,
                                      const Progress& progress) {
  std::vector<ImageryInfo> infos;
  for (const std::string& dataset : imagery) {
    infos.push_back(inspect_imagery(dataset, options, progress));
    if (!options.bands.empty() || !looks_like_heights(infos.back())) continue;
    throw DataError(dataset + ": its one band of " + infos.back().band_type +
                    " values looks like an elevation model, not like imagery; give it as --elevation, or name the "
                    "band if it is a picture (--bands 1)");
  }
  return infos;
}

std::string size_text(double width_m, double height_m) {
  return format_fixed(width_m, 0) + " m x " + format_fixed(height_m, 0) + " m";
}

// The points of the grid at which its scale is looked at.
std::vector<GeodeticPoint> lattice_of(const Ground& ground) {
  constexpr int kSteps = 8;
  const TileMatrix& matrix = ground.levels.front().matrix;
  const CrsTransform transform(ground.crs);
  std::vector<GeodeticPoint> points;
  for (int row = 0; row <= kSteps; ++row) {
    for (int column = 0; column <= kSteps; ++column) {
      const auto point = transform.geodetic_from_map(
          matrix.map_from_pixel.map_from_pixel({static_cast<double>(matrix.grid_width_px) * column / kSteps,
                                                static_cast<double>(matrix.grid_height_px) * row / kSteps}));
      if (point) points.push_back(*point);
    }
  }
  return points;
}

void refuse_many_tiles(const GridLevel& level, double stride_m) {
  const TileMatrix& matrix = level.matrix;
  if (matrix.tile_count() <= kMostSurveyedTiles) return;
  throw DataError("the area of " +
                  size_text(static_cast<double>(matrix.grid_width_px) * level.gsd_m,
                            static_cast<double>(matrix.grid_height_px) * level.gsd_m) +
                  " holds " + std::to_string(matrix.tile_count()) + " tiles, one every " + format_fixed(stride_m, 1) +
                  " m; at most " + std::to_string(kMostSurveyedTiles) +
                  " are surveyed at once; take a smaller --tile-overlap, look at the field of view and --agl-m, or "
                  "survey it in parts (gdal_translate -projwin)");
}

}  // namespace

SurveyedGround plan_survey(const std::vector<std::string>& imagery, const SurveyOptions& options,
                           const Progress& progress) {
  check_options(options);
  SurveyedGround area;
  if (!options.camera.name.empty()) area.camera_name = camera_product(options.camera.name).name;
  if (imagery.empty()) throw UsageError("imagery is missing: name the rasters of the area");
  area.camera = make_camera(options.camera);
  if (!options.agl_m) {
    throw UsageError("agl_m is missing; give --agl-m, the height above ground that the camera looks down from");
  }
  area.agl_m = *options.agl_m;
  const double side_m = footprint_side_m(area.camera, area.agl_m);
  const Footprint shape = footprint(area.camera, Attitude{}, area.agl_m);
  area.footprint_width_m = shape.across_m;
  area.footprint_height_m = shape.along_m;
  area.search_radius_m = options.search_radius_m.value_or(kAssumedSearchRadius_m);
  area.search_radius_assumed = !options.search_radius_m;

  const std::vector<ImageryInfo> infos = inspect_area(imagery, options.imagery_options, progress);
  refuse_imagery_as_elevation(options.elevation, imagery);
  double imagery_gsd_m = 0;
  for (const ImageryInfo& info : infos) imagery_gsd_m = std::max({imagery_gsd_m, info.gsd_x_m, info.gsd_y_m});
  const GroundSampleDistance camera_gsd = gsd_m(area.camera, area.agl_m);
  const double camera_gsd_m = std::max(camera_gsd.across_m, camera_gsd.along_m);
  const WorkingGsd working = choose_working_gsd(options.gsd_m, imagery_gsd_m, camera_gsd_m, side_m);
  area.notes.push_back("Grid: " + format_fixed(working.gsd_m, 3) + " m/px, " + working.reason);

  RasterGridOptions grid;
  grid.tile_size_px = 2;  // any that fits; the footprint's comes below, with words that name it
  grid.imagery = options.imagery_options;
  grid.gsd_m = working.gsd_m;
  grid.crs = options.crs;
  area.ground = ground_of_inspected(infos, grid);
  set_imagery_dates(options.imagery_date, area.ground.imagery.datasets);
  if (!options.flight_time.empty()) {
    static_cast<void>(utc_date_of_option("flight_time", options.flight_time));
    area.ground.flight_time = options.flight_time;
  }
  area.ground.elevation = options.elevation;
  GridLevel& level = area.ground.levels.front();
  level.min_agl_m = level.max_agl_m = area.agl_m;
  level.search_radius_px = std::max(1, static_cast<int>(std::ceil(area.search_radius_m / working.gsd_m)));
  level.matrix.tile_size_px = std::clamp(static_cast<int>(std::lround(side_m / working.gsd_m)), 16, 8192);
  level.matrix.stride_px =
      std::max(1, static_cast<int>(std::lround(level.matrix.tile_size_px * (1 - options.tile_overlap))));
  const double tile_m = level.matrix.tile_size_px * working.gsd_m;
  if (level.matrix.tile_count() == 0) {
    throw DataError("the camera's footprint from " + format_number(area.agl_m) + " m, as a square " +
                    format_fixed(tile_m, 0) + " m wide, is larger than the imagery of " +
                    size_text(static_cast<double>(level.matrix.grid_width_px) * working.gsd_m,
                              static_cast<double>(level.matrix.grid_height_px) * working.gsd_m) +
                    "; add imagery, or look at --agl-m and the field of view");
  }
  refuse_many_tiles(level, level.matrix.stride_px * working.gsd_m);
  area.ground.max_scale_distortion = scale_distortion(area.ground.crs, lattice_of(area.ground));
  area.notes.push_back("Areas are those of the grid, whose scale is within " +
                       format_fixed(100 * area.ground.max_scale_distortion, 4) + " % of true");

  const double usable_gsd_m = choose_working_gsd({}, 0, camera_gsd_m, side_m).gsd_m;
  area.warnings = imagery_warnings(infos, usable_gsd_m);
  area.imagery_infos = infos;
  return area;
}

}  // namespace pilotage
