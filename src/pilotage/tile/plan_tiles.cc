#include "pilotage/tile/plan_tiles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/text.h"
#include "pilotage/base/utc_time.h"
#include "pilotage/base/utf8.h"
#include "pilotage/camera/camera_products.h"
#include "pilotage/camera/projection.h"
#include "pilotage/ground/ground_of_rasters.h"
#include "pilotage/ins/drift.h"
#include "pilotage/ins/ins_error_model.h"
#include "pilotage/ins/ins_products.h"
#include "pilotage/raster/elevation.h"
#include "pilotage/raster/gdal_io.h"
#include "pilotage/raster/gray_stretch.h"
#include "pilotage/raster/mission_crs.h"
#include "pilotage/route/read_route.h"
#include "pilotage/route/sample_route.h"
#include "pilotage/tile/cloud_table.h"
#include "pilotage/tile/corridor.h"
#include "pilotage/tile/denied_stretches.h"
#include "pilotage/tile/map_error.h"
#include "pilotage/tile/plan_levels.h"
#include "pilotage/tile/route_cover.h"
#include "pilotage/tile/working_gsd.h"

namespace pilotage {
namespace {

constexpr double kSampleStep_m = 10;

void require(bool given, const char* what) {
  if (!given) throw UsageError(std::string(what) + " is missing; give it as --" + what + ", or in a mission file");
}

void check_grid_origin(const TileOptions& options) {
  const std::vector<double>& origin_m = options.grid_origin_m;
  if (origin_m.empty()) return;
  if (origin_m.size() != 2) {
    throw UsageError("grid_origin_m has " + std::to_string(origin_m.size()) +
                     " numbers; it is x and y of a corner of a tile, as 412000,6153000");
  }
  constexpr double kFarthest_m = 1e8;  // beyond which no CRS reaches
  for (const double value_m : origin_m) {
    if (std::abs(value_m) <= kFarthest_m) continue;
    throw UsageError("grid_origin_m = " + format_number(value_m) + " is outside [-100000000, 100000000]");
  }
  if (options.crs.empty()) throw UsageError("grid_origin_m is a point of the grid's CRS; give --crs, too");
}

std::vector<ImageryInfo> inspect_all(const TileOptions& options, const Progress& progress) {
  std::vector<ImageryInfo> infos;
  for (const auto& dataset : options.imagery) {
    infos.push_back(inspect_imagery(dataset, options.imagery_options, progress));
  }
  return infos;
}

double coarsest_gsd_m(const std::vector<ImageryInfo>& infos) {
  double gsd_m = 0;
  for (const auto& info : infos) gsd_m = std::max({gsd_m, info.gsd_x_m, info.gsd_y_m});
  return gsd_m;
}

/// Of an elevation model of which nothing else is known: errors of lidar's models are about a metre, those of global
/// ones from radar about four (Copernicus DEM, product handbook: 4 m at 90 % linear error on gentle ground).
double sigma_of_elevation_m(const Elevation& elevation) {
  constexpr double kLidarSpacing_m = 5.5;  // 5 m, by whatever ellipsoid and scale
  return elevation.resolution_m() <= kLidarSpacing_m ? 1 : 4;
}

// The model, nullptr without one; what it is goes to the mission.
std::shared_ptr<const Elevation> open_elevation(const TileOptions& options, Mission& mission) {
  Ground& ground = mission.ground;
  if (options.elevation.empty()) {
    if (!options.elevation_licence.empty() || !options.elevation_attribution.empty()) {
      throw UsageError("elevation_licence and elevation_attribution are of an elevation model, and none is given");
    }
    if (options.elevation_sigma_m) throw UsageError("elevation_sigma_m is of an elevation model, and none is given");
    return nullptr;
  }
  auto model = std::make_shared<const Elevation>(options.elevation);
  ground.elevation = options.elevation;
  ground.elevation_sigma_m = options.elevation_sigma_m ? *options.elevation_sigma_m : sigma_of_elevation_m(*model);
  ground.elevation_licence =
      licence_or({options.elevation_licence, options.elevation_attribution}, read_licence(options.elevation));
  ground.elevation_datum = model->vertical_datum();
  ground.elevation_datum_assumed = model->datum_assumed();
  mission.notes.push_back("Heights of the ground: " + options.elevation + ", " + ground.elevation_datum);
  return model;
}

// Warns of values that stand, or may stand, for no height; those that do as one text.
std::string warn_of_voids(const Elevation& model, Mission& mission) {
  std::vector<GeodeticPoint> points;
  for (const RouteVertex& vertex : mission.flight.route.vertices) points.push_back(vertex.point);
  std::vector<std::string> certain;
  for (const UndeclaredVoid& found : model.undeclared_voids(points)) {
    mission.warnings.push_back(undeclared_void_text(model.dataset(), found));
    if (found.certain) certain.push_back(mission.warnings.back());
  }
  return join(certain, "; ");
}

// The ground's height above sea level: of the elevation model, or flat at home where the route's heights need one and
// only home's is known.
TerrainHeight open_terrain(const std::shared_ptr<const Elevation>& model,
                           const std::optional<double>& flat_ground_amsl_m) {
  if (flat_ground_amsl_m) return [amsl_m = *flat_ground_amsl_m](GeodeticPoint) { return amsl_m; };
  if (!model) return {};
  return [model](GeodeticPoint point) { return model->amsl_m(point); };
}

// Heights above home say nothing of the ground elsewhere; without an elevation model it is taken to be flat.
void assume_flat_ground(const RouteOptions& options, Mission& mission) {
  const Route& route = mission.flight.route;
  const bool needs_ground = std::any_of(route.vertices.begin(), route.vertices.end(),
                                        [](const RouteVertex& vertex) { return !std::isfinite(vertex.agl_m); });
  const double home_amsl_m = options.home_amsl_m.value_or(route.home ? route.home->amsl_m : kNaN);
  if (!mission.ground.elevation.empty() || !needs_ground || !std::isfinite(home_amsl_m)) return;
  mission.flight.flat_ground_amsl_m = home_amsl_m;
  mission.warnings.push_back("no elevation model is given: the ground is assumed flat at home's height, " +
                             format_fixed(home_amsl_m, 1) +
                             " m above sea level; where it is higher or lower, frames show less or more than planned; "
                             "give --elevation");
}

// The samples of the plan's route, and what a planner should look at again in its heights.
void sample_plan_route(const std::shared_ptr<const Elevation>& model, Mission& mission) {
  const TerrainHeight terrain = open_terrain(model, mission.flight.flat_ground_amsl_m);
  const std::string voids = model ? warn_of_voids(*model, mission) : "";
  std::vector<RouteSample> samples;
  try {
    samples = sample_route(mission.flight.route, kSampleStep_m, terrain);
  } catch (const DataError& error) {
    // A void may be why.
    if (voids.empty()) throw;
    throw DataError(std::string(error.what()) + "; " + voids);
  }
  for (const RouteSample& sample : samples) {
    mission.flight.samples.push_back(FlightSample{sample});
    if (!std::isfinite(sample.speed_mps)) {
      throw UsageError(mission.flight.route.name + ": leg " + std::to_string(sample.leg + 1) +
                       " has no speed; give --speed-mps (metres per second over ground)");
    }
  }
  // Who plans to match from lower than this means to fly there.
  const double low_agl_m = std::min(kLowAgl_m, mission.flight.min_agl_m);
  for (std::string& warning : route_height_warnings(mission.flight.route, samples, terrain, low_agl_m)) {
    mission.warnings.push_back(std::move(warning));
  }
}

MissionCrs mission_crs(const TileOptions& options, const Route& route, double half_width_m) {
  std::vector<GeodeticPoint> points;
  for (const RouteVertex& vertex : route.vertices) points.push_back(vertex.point);
  if (options.crs.empty()) return choose_mission_crs(points, half_width_m);
  return check_mission_crs(Crs::from_user_input(options.crs), points, half_width_m);
}

void place_samples(std::vector<FlightSample>& samples, const Crs& crs) {
  const CrsTransform transform(crs);
  for (FlightSample& sample : samples) {
    const auto point = transform.map_from_geodetic(sample.point);
    if (!point) {
      throw DataError("the route at lon " + format_fixed(sample.point.lon_deg, 6) + ", lat " +
                      format_fixed(sample.point.lat_deg, 6) + " has no image in " + crs.name());
    }
    sample.point_map_m = *point;
  }
}

// Runs of consecutive samples of one level, on the grid.
std::vector<std::vector<GridSample>> runs_of_level(const std::vector<FlightSample>& samples, int level) {
  std::vector<std::vector<GridSample>> runs;
  const FlightSample* before = nullptr;
  for (const FlightSample& sample : samples) {
    if (sample.level == level) {
      const bool joined = before != nullptr && before->level == level && before->leg == sample.leg;
      if (!joined) runs.emplace_back();
      runs.back().push_back({sample.point_map_m, sample.distance_m});
    }
    before = &sample;
  }
  return runs;
}

// The grid begins at whole strides of the tiles from `origin_m`, where one is given; else at whole pixels.
GridLevel make_level(int index, const AglBand& band, double gsd_m, int tile_size_px, double overlap, double reach_m,
                     const std::vector<double>& origin_m, const std::vector<FlightSample>& samples) {
  GridLevel level;
  level.gsd_m = gsd_m;
  level.min_agl_m = band.min_agl_m;
  level.max_agl_m = band.max_agl_m;
  level.matrix.level = index;
  level.matrix.tile_size_px = tile_size_px;
  level.matrix.stride_px = std::max(1, static_cast<int>(std::lround(tile_size_px * (1 - overlap))));

  Bounds bounds;
  for (const FlightSample& sample : samples) {
    if (sample.level == index) bounds.extend(sample.point_map_m);
  }
  const Bounds grid = bounds.grown(reach_m + tile_size_px * gsd_m);
  const double step_m = origin_m.empty() ? gsd_m : level.matrix.stride_px * gsd_m;
  const Eigen::Vector2d origin = origin_m.empty() ? Eigen::Vector2d(0, 0) : Eigen::Vector2d(origin_m[0], origin_m[1]);
  const double min_x_m = origin.x() + std::floor((grid.min_x_m - origin.x()) / step_m) * step_m;
  const double max_y_m = origin.y() + std::ceil((grid.max_y_m - origin.y()) / step_m) * step_m;
  level.matrix.map_from_pixel = GeoTransform::north_up(min_x_m, max_y_m, gsd_m);
  level.matrix.grid_width_px = static_cast<std::int64_t>(std::ceil((grid.max_x_m - min_x_m) / gsd_m));
  level.matrix.grid_height_px = static_cast<std::int64_t>(std::ceil((max_y_m - grid.min_y_m) / gsd_m));
  return level;
}

// How far from the route the centres of a level's tiles may lie: at least half the diagonal of a stride, so that the
// tile nearest to a point of the route (tile_under) is always there, however narrow the corridor.
double reach_of_tiles_m(const GridLevel& level, double corridor_half_width_m) {
  return std::max(corridor_half_width_m, std::sqrt(0.5) * level.matrix.stride_px * level.gsd_m);
}

// Refuses a corridor of more tiles than a ground may have, before memory is taken for them. Estimated: a strip with
// round ends about the way that the level serves.
void refuse_too_many_tiles(const GridLevel& level, double reach_m, const std::vector<FlightSample>& samples) {
  double way_m = 0;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    if (samples[i].level == level.matrix.level) way_m += samples[i].distance_m - samples[i - 1].distance_m;
  }
  const double stride_m = level.matrix.stride_px * level.gsd_m;
  const double strip_tiles = (2 * reach_m * way_m + std::numbers::pi * reach_m * reach_m) / (stride_m * stride_m);
  const double tiles = std::min(strip_tiles, static_cast<double>(level.matrix.tile_count()));
  if (tiles <= static_cast<double>(kMostTiles)) return;
  throw DataError("the corridor, " + format_fixed(2 * reach_m, 0) + " m wide and " + format_fixed(way_m / 1000, 0) +
                  " km long, holds some " + format_fixed(tiles, 0) + " tiles, one every " + format_fixed(stride_m, 2) +
                  " m; at most " + std::to_string(kMostTiles) +
                  " are planned; look at corridor_half_width_m, the field of view and agl_m, or divide the route");
}

// Gives every sample its level; returns the bands of heights.
std::vector<AglBand> serve_heights(Mission& mission) {
  std::vector<double> heights_m;
  for (const FlightSample& sample : mission.flight.samples) {
    if (sample.agl_m >= mission.flight.min_agl_m) heights_m.push_back(sample.agl_m);
  }
  if (heights_m.empty()) {
    throw DataError(mission.flight.route.name + ": no part of the route is higher than min_agl_m = " +
                    format_number(mission.flight.min_agl_m) + " above the ground");
  }
  const std::vector<AglBand> bands = agl_bands(heights_m);
  double low_m = 0;
  const FlightSample* before = nullptr;
  for (FlightSample& sample : mission.flight.samples) {
    const bool high_enough = sample.agl_m >= mission.flight.min_agl_m;
    sample.level = high_enough ? band_of(bands, sample.agl_m) : FlightSample::kNoLevel;
    if (before != nullptr && !high_enough) low_m += sample.distance_m - before->distance_m;
    before = &sample;
  }
  if (low_m > 0) {
    mission.warnings.push_back(format_fixed(low_m, 0) + " m of the route are flown lower than " +
                               format_number(mission.flight.min_agl_m) +
                               " m above the ground, where no matching is expected");
  }
  return bands;
}

// One level for each band: its ground sample distance, tile size, grid and search radius.
void cut_levels(const TileOptions& options, const std::vector<ImageryInfo>& infos, const std::vector<AglBand>& bands,
                Mission& mission) {
  const double tilt_rad = attitude_error(initial_ins_state(make_ins_error_model(mission.flight.ins), 0,
                                                           mission.flight.samples.front().speed_mps),
                                         mission.flight.ins.sigma_multiple)
                              .tilt_rad;
  for (std::size_t i = 0; i < bands.size(); ++i) {
    const double agl_m = bands[i].typical_agl_m;
    const double side_m = footprint_side_m(mission.flight.camera, agl_m);
    const GroundSampleDistance camera_gsd = gsd_m(mission.flight.camera, agl_m);
    const double camera_gsd_m = std::max(camera_gsd.across_m, camera_gsd.along_m);
    const WorkingGsd working = choose_working_gsd(options.gsd_m, coarsest_gsd_m(infos), camera_gsd_m, side_m);
    mission.notes.push_back("Level " + std::to_string(i) + ": " + format_fixed(working.gsd_m, 3) + " m/px, " +
                            working.reason);
    const int tile_size_px =
        options.tile_size_px.value_or(std::clamp(static_cast<int>(std::lround(side_m / working.gsd_m)), 16, 8192));
    const double radius_m = search_radius_m(mission.flight.max_error_m, 0, bands[i].max_agl_m, tilt_rad);
    GridLevel level =
        make_level(static_cast<int>(i), bands[i], working.gsd_m, tile_size_px, options.tile_overlap,
                   mission.flight.corridor_half_width_m + radius_m, options.grid_origin_m, mission.flight.samples);
    level.search_radius_px = std::max(1, static_cast<int>(std::ceil(radius_m / working.gsd_m)));
    refuse_too_many_tiles(level, reach_of_tiles_m(level, mission.flight.corridor_half_width_m), mission.flight.samples);
    mission.ground.levels.push_back(level);
    if (i == 0) {
      const Footprint shape = footprint(mission.flight.camera, Attitude{}, agl_m);
      mission.flight.footprint_width_m = shape.across_m;
      mission.flight.footprint_height_m = shape.along_m;
      const double usable_gsd_m = choose_working_gsd({}, 0, camera_gsd_m, side_m).gsd_m;
      for (auto& warning : imagery_warnings(infos, usable_gsd_m)) mission.warnings.push_back(std::move(warning));
    }
  }
}

// Coverage of each tile: the share of its pixels that `score` will find valid.
void measure_coverage(const GraySource& source, const TileMatrix& matrix, std::span<GroundTile> tiles,
                      const Progress& progress) {
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    tiles[i].valid_fraction = valid_fraction(source, matrix.tile_window(tiles[i].column, tiles[i].row));
    report_progress(progress, "coverage", static_cast<std::int64_t>(i + 1), static_cast<std::int64_t>(tiles.size()));
  }
}

// Adds the tiles of a level to the ground, with their places along the route to the flight.
void cut_tiles(int level, Mission& mission) {
  const GridLevel& plan_level = mission.ground.levels[static_cast<std::size_t>(level)];
  const TileMatrix& matrix = plan_level.matrix;
  const CrsTransform transform(mission.ground.crs);
  for (const CorridorTile& cell :
       corridor_tiles(runs_of_level(mission.flight.samples, level),
                      reach_of_tiles_m(plan_level, mission.flight.corridor_half_width_m), matrix)) {
    GroundTile tile;
    tile.tile_id = tile_id_of(mission.ground.levels, level, cell.column, cell.row);
    tile.level = level;
    tile.column = cell.column;
    tile.row = cell.row;
    tile.bounds = matrix.tile_bounds({cell.column, cell.row});
    tile.center = transform.geodetic_from_map(tile.bounds.center_m()).value();
    mission.ground.tiles.push_back(tile);
    mission.flight.places.push_back({cell.route_distance_m, cell.route_offset_m});
  }
}

// Refuses a route that leaves the imagery, or says so where that is allowed.
void judge_cover(const std::string& stretches, const std::string& sentence, bool allow_uncovered, Mission& mission) {
  if (stretches.empty()) return;
  const std::string text = mission.flight.route.name + ": " + sentence + " " + stretches;
  if (!allow_uncovered) throw DataError(text + "; add imagery, or give --allow-uncovered to plan with a gap there");
  mission.warnings.push_back(text);
}

// Names the first level whose tiles are wider or higher than all imagery together; "" when there is none.
std::string tile_larger_than_imagery(const Mission& mission, const std::vector<ImageryInfo>& infos, const Crs& crs) {
  Bounds extent;
  for (const auto& info : infos) {
    const Bounds part = imagery_bounds(info, crs);
    if (part.empty()) continue;
    extent.extend({part.min_x_m, part.min_y_m});
    extent.extend({part.max_x_m, part.max_y_m});
  }
  for (const GridLevel& level : mission.ground.levels) {
    const double side_m = level.matrix.tile_size_px * level.gsd_m;
    const double width_m = extent.max_x_m - extent.min_x_m;
    const double height_m = extent.max_y_m - extent.min_y_m;
    if (side_m <= width_m && side_m <= height_m) continue;
    return "level " + std::to_string(level.matrix.level) + ": a tile of " + std::to_string(level.matrix.tile_size_px) +
           " px is " + format_fixed(side_m, 0) + " m wide, larger than the imagery of " + format_fixed(width_m, 0) +
           " m x " + format_fixed(height_m, 0) + " m";
  }
  return "";
}

// Input that can be used, but is hardly what was meant.
void warn_of_mistakes(const std::vector<ImageryInfo>& infos, Mission& mission) {
  for (const ImageryInfo& info : infos) {
    if (!looks_like_heights(info)) continue;
    mission.warnings.push_back(info.dataset + ": its one band of " + info.band_type +
                               " values looks like an elevation model, not like imagery; give it as --elevation");
  }
}

void add_imagery(Mission& mission, const TileOptions& options, const std::vector<ImageryInfo>& infos) {
  std::vector<ImageryDataset>& datasets = mission.ground.imagery.datasets;
  for (const ImageryInfo& info : infos) {
    datasets.push_back({info.dataset, std::max(info.gsd_x_m, info.gsd_y_m), info.crs.name(), info.acquired,
                        info.width_px, info.height_px, info.map_sigma,
                        licence_or({options.licence, options.attribution}, info.licence)});
  }
  set_imagery_dates(options.imagery_date, datasets);
}

// When it is flown, and how often the ground can be seen then.
void add_flight_time(const TileOptions& options, Mission& mission) {
  if (options.flight_time.empty()) {
    if (!options.clouds.empty()) {
      throw UsageError("clouds = \"" + name_as_utf8(options.clouds) +
                       "\" needs flight_time: hidden ground is counted by month");
    }
    return;
  }
  const UtcDate begins = utc_date_of_option("flight_time", options.flight_time);
  mission.ground.flight_time = options.flight_time;
  if (options.clouds.empty()) return;
  const double fraction = hidden_fraction(options.clouds, begins);
  mission.flight.ground_hidden = GroundHidden{fraction, options.clouds};
}

}  // namespace

Mission plan_tiles(const TileOptions& options, const Progress& progress) {
  check_options(options);
  if (!options.camera.name.empty()) camera_product(options.camera.name);  // "list" asks for nothing else
  if (options.ins.name) ins_product(*options.ins.name);
  require(!options.imagery.empty(), "imagery");
  require(!options.route.empty(), "route");
  refuse_imagery_as_elevation(options.elevation, options.imagery);
  check_grid_origin(options);

  Mission mission;
  const auto infos = inspect_all(options, progress);
  add_imagery(mission, options, infos);
  warn_of_mistakes(infos, mission);
  const std::shared_ptr<const Elevation> elevation = open_elevation(options, mission);
  mission.flight.route_file = options.route;
  mission.ground.imagery.options = options.imagery_options;
  mission.flight.route = read_route(options.route, options.route_options);
  mission.flight.camera = make_camera(options.camera, mission.flight.route.camera);
  mission.flight.ins = options.ins;
  mission.flight.conditions = options.conditions;
  if (options.ins.name) {
    const InsProduct& product = ins_product(*options.ins.name);
    if (!product.confirmed) {
      mission.warnings.push_back("the figures of the " + std::string(product.name) +
                                 " are not confirmed: compare them with " + std::string(product.source) +
                                 ", and give those that differ (--ins-angle-random-walk-deg-rt-h, …)");
    }
  } else if (!options.ins.grade) {
    mission.warnings.emplace_back(
        "no inertial grade is given (--ins-grade): tactical is assumed; with a lower grade the aircraft drifts "
        "faster, and the same flight may be lost");
  }
  add_placement_error(infos, mission);
  mission.flight.max_error_m = options.max_error_m.value_or(kAssumedMaxError_m);
  mission.flight.max_error_assumed = !options.max_error_m;
  mission.flight.autopilot = options.autopilot;
  add_flight_time(options, mission);
  mission.flight.min_agl_m = options.min_agl_m;
  mission.flight.corridor_half_width_m = options.corridor_half_width_m.value_or(mission.flight.max_error_m);
  assume_flat_ground(options.route_options, mission);
  sample_plan_route(elevation, mission);
  if (options.denied) {
    mission.flight.denied = read_denial(*options.denied, mission.flight.samples, mission.warnings);
  }

  const MissionCrs grid = mission_crs(options, mission.flight.route, mission.flight.corridor_half_width_m);
  mission.ground.crs = grid.crs;
  mission.ground.max_scale_distortion = grid.max_scale_distortion;
  mission.notes.push_back("Mission grid: " + grid.reason);
  place_samples(mission.flight.samples, grid.crs);

  std::string outside = outside_imagery(mission.flight.samples, infos, grid.crs);
  if (!outside.empty()) outside += swapped_axes_hint(mission.flight.samples.front().point, infos);
  judge_cover(outside, "the route leaves the imagery", options.allow_uncovered, mission);

  const std::vector<AglBand> bands = serve_heights(mission);
  cut_levels(options, infos, bands, mission);
  const std::string too_large = tile_larger_than_imagery(mission, infos, grid.crs);
  if (!too_large.empty()) {
    if (!options.allow_uncovered) throw DataError(too_large + "; add imagery, or give a smaller --tile-size-px");
    mission.warnings.push_back(too_large);
  }
  for (std::size_t level = 0; level < mission.ground.levels.size(); ++level) {
    const std::size_t first = mission.ground.tiles.size();
    cut_tiles(static_cast<int>(level), mission);
    const GridLevel& cut = mission.ground.levels[level];
    const GraySource valid =
        open_valid_on_grid(options.imagery, grid.crs, cut.matrix.map_from_pixel, cut.matrix.grid_width_px,
                           cut.matrix.grid_height_px, options.imagery_options);
    judge_cover(over_no_data(mission.flight.samples, cut, valid, infos, grid.crs),
                "the route lies where the imagery has no data", options.allow_uncovered, mission);
    measure_coverage(valid, cut.matrix, std::span(mission.ground.tiles).subspan(first), progress);
  }
  if (mission.ground.tiles.empty())
    throw DataError("the corridor holds no tile; look at corridor_half_width_m and tile_size_px");
  add_map_sigma(options.conditions, mission);
  return mission;
}

}  // namespace pilotage
