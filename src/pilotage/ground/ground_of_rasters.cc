#include "pilotage/ground/ground_of_rasters.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "pilotage/base/error.h"
#include "pilotage/base/parallel.h"
#include "pilotage/base/utc_time.h"
#include "pilotage/raster/gdal_io.h"
#include "pilotage/raster/mission_crs.h"

namespace pilotage {
namespace {

constexpr int kTileSize_px = 256;
constexpr int kStride_px = 64;
constexpr int kSearchRadius_px = 128;

/// Pixels in a CRS.
struct PixelGrid {
  Crs crs;
  GeoTransform map_from_pixel;
  std::int64_t width_px = 0;
  std::int64_t height_px = 0;
  double gsd_m = 0;
};

// The corners of a raster on the ground.
std::vector<GeodeticPoint> corners(const ImageryInfo& info) {
  const CrsTransform transform(info.crs);
  std::vector<GeodeticPoint> points;
  for (const double row : {0.0, static_cast<double>(info.height_px)}) {
    for (const double col : {0.0, static_cast<double>(info.width_px)}) {
      if (const auto point = transform.geodetic_from_map(info.map_from_pixel.map_from_pixel({col, row}))) {
        points.push_back(*point);
      }
    }
  }
  return points;
}

Crs grid_crs(const std::vector<ImageryInfo>& infos, const std::string& wanted) {
  constexpr double kEdge_m = 1;
  std::vector<GeodeticPoint> points;
  for (const ImageryInfo& info : infos) {
    for (const GeodeticPoint& point : corners(info)) points.push_back(point);
  }
  if (!wanted.empty()) return check_mission_crs(Crs::from_user_input(wanted), points, kEdge_m).crs;
  const Crs& own = infos.front().crs;
  if (own.is_projected() && own.metres_per_unit() == 1.0 && scale_distortion(own, points) <= kMaxScaleDistortion) {
    return own;
  }
  return choose_mission_crs(points, kEdge_m).crs;
}

PixelGrid own_grid(const ImageryInfo& info) {
  return {info.crs, info.map_from_pixel, info.width_px, info.height_px, std::max(info.gsd_x_m, info.gsd_y_m)};
}

PixelGrid resampled_grid(const std::vector<ImageryInfo>& infos, const RasterGridOptions& options) {
  if (!options.gsd_m) {
    throw UsageError(infos.size() > 1 ? "several rasters need a common grid; give --gsd-m" : "--crs needs --gsd-m");
  }
  const double gsd_m = *options.gsd_m;
  const Crs crs = grid_crs(infos, options.crs);
  Bounds bounds;
  for (const ImageryInfo& info : infos) {
    const Bounds part = imagery_bounds(info, crs);
    if (part.empty()) throw DataError(info.dataset + ": has no image in " + crs.name());
    bounds.extend({part.min_x_m, part.min_y_m});
    bounds.extend({part.max_x_m, part.max_y_m});
  }
  const double min_x_m = std::floor(bounds.min_x_m / gsd_m) * gsd_m;
  const double max_y_m = std::ceil(bounds.max_y_m / gsd_m) * gsd_m;
  return {crs, GeoTransform::north_up(min_x_m, max_y_m, gsd_m),
          static_cast<std::int64_t>(std::ceil((bounds.max_x_m - min_x_m) / gsd_m)),
          static_cast<std::int64_t>(std::ceil((max_y_m - bounds.min_y_m) / gsd_m)), gsd_m};
}

GridLevel cut_level(const PixelGrid& grid, const RasterGridOptions& options) {
  constexpr double kNotKnown = std::numeric_limits<double>::quiet_NaN();
  GridLevel level;
  level.matrix = {0,
                  grid.map_from_pixel,
                  grid.width_px,
                  grid.height_px,
                  options.tile_size_px.value_or(kTileSize_px),
                  options.stride_px.value_or(kStride_px)};
  level.gsd_m = grid.gsd_m;
  level.min_agl_m = level.max_agl_m = kNotKnown;
  level.search_radius_px = options.search_radius_px.value_or(kSearchRadius_px);
  if (level.matrix.tile_count() > 0) return level;
  const std::string side = std::to_string(level.matrix.tile_size_px);
  throw DataError("tile_size_px = " + side + ": a tile of " + side + " x " + side +
                  " px is larger than the imagery of " + std::to_string(grid.width_px) + " x " +
                  std::to_string(grid.height_px) + " px");
}

// The rectangle around a tile, its axes in metres; NaN where the CRS counts degrees.
Bounds metric_bounds(const Bounds& bounds, double metres_per_unit) {
  return {bounds.min_x_m * metres_per_unit, bounds.min_y_m * metres_per_unit, bounds.max_x_m * metres_per_unit,
          bounds.max_y_m * metres_per_unit};
}

void refuse_too_many_tiles(std::int64_t tiles, const TileMatrix& matrix) {
  if (tiles <= kMostTiles) return;
  throw DataError(std::to_string(tiles) + " tiles (of " + std::to_string(matrix.tile_size_px) + " px, every " +
                  std::to_string(matrix.stride_px) + " px of " + std::to_string(matrix.grid_width_px) + " x " +
                  std::to_string(matrix.grid_height_px) + " px) do not fit in memory, at most " +
                  std::to_string(kMostTiles) +
                  " are scored at once; take a larger --stride-px or --gsd-m, a part of the raster (gdal_translate "
                  "-projwin), or --shard");
}

}  // namespace

RasterGround ground_of_rasters(const std::vector<std::string>& datasets, const RasterGridOptions& options,
                               const Progress& progress) {
  check_options(options);
  std::vector<ImageryInfo> infos;
  for (const std::string& dataset : datasets) infos.push_back(inspect_imagery(dataset, options.imagery, progress));
  return {ground_of_inspected(infos, options), imagery_warnings(infos, 0)};
}

void set_imagery_dates(const std::optional<std::vector<std::string>>& dates, std::vector<ImageryDataset>& datasets) {
  if (!dates) return;
  if (dates->size() != 1 && dates->size() != datasets.size()) {
    throw UsageError("imagery_date has " + std::to_string(dates->size()) + " dates for " +
                     std::to_string(datasets.size()) + " rasters; give one for all or one for each");
  }
  for (std::size_t i = 0; i < datasets.size(); ++i) {
    const std::string& date = (*dates)[dates->size() == 1 ? 0 : i];
    static_cast<void>(utc_date_of_option("imagery_date", date));
    datasets[i].acquired = date;
  }
}

Ground ground_of_inspected(const std::vector<ImageryInfo>& infos, const RasterGridOptions& options) {
  if (infos.empty()) throw UsageError("there is no raster to score");
  Ground ground;
  for (const ImageryInfo& info : infos) {
    ground.imagery.datasets.push_back({info.dataset, std::max(info.gsd_x_m, info.gsd_y_m), info.crs.name(),
                                       info.acquired, info.width_px, info.height_px, info.map_sigma, info.licence});
  }
  ground.imagery.options = options.imagery;
  ground.imagery.own_grid = infos.size() == 1 && !options.gsd_m && options.crs.empty();
  const PixelGrid grid = ground.imagery.own_grid ? own_grid(infos.front()) : resampled_grid(infos, options);
  ground.crs = grid.crs;
  ground.levels.push_back(cut_level(grid, options));
  return ground;
}

void cut_tiles(Ground& ground, std::span<const std::int64_t> indices, int threads) {
  constexpr std::size_t kTilesAtOnce = 4096;
  constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();
  const TileMatrix& matrix = ground.levels.front().matrix;
  refuse_too_many_tiles(std::ssize(indices), matrix);
  const double metres_per_unit = ground.crs.metres_per_unit();
  std::vector<std::optional<CrsTransform>> transforms(static_cast<std::size_t>(thread_count(threads)));
  ground.tiles.resize(indices.size());
  parallel_for((indices.size() + kTilesAtOnce - 1) / kTilesAtOnce, threads, [&](std::size_t block, int worker) {
    std::optional<CrsTransform>& transform = transforms[static_cast<std::size_t>(worker)];
    if (!transform) transform.emplace(ground.crs);
    const std::size_t end = std::min((block + 1) * kTilesAtOnce, indices.size());
    for (std::size_t i = block * kTilesAtOnce; i < end; ++i) {
      GroundTile& tile = ground.tiles[i];
      const TileCell cell = matrix.cell_of(indices[i]);
      tile.tile_id = indices[i];
      tile.column = cell.column;
      tile.row = cell.row;
      tile.bounds = metric_bounds(matrix.tile_bounds(cell), metres_per_unit);
      tile.center = transform->geodetic_from_map(matrix.tile_center(cell)).value_or(GeodeticPoint{kNowhere, kNowhere});
      tile.valid_fraction = kNowhere;
    }
  });
}

void cut_all_tiles(Ground& ground, int threads) {
  const TileMatrix& matrix = ground.levels.front().matrix;
  refuse_too_many_tiles(matrix.tile_count(), matrix);
  std::vector<std::int64_t> all(static_cast<std::size_t>(matrix.tile_count()));
  std::iota(all.begin(), all.end(), 0);
  cut_tiles(ground, all, threads);
}

void refuse_raster_grid(const RasterGridOptions& options, const std::string& plan) {
  const std::pair<const char*, bool> given[] = {{"tile_size_px", options.tile_size_px.has_value()},
                                                {"stride_px", options.stride_px.has_value()},
                                                {"search_radius_px", options.search_radius_px.has_value()},
                                                {"bands", !options.imagery.bands.empty()},
                                                {"imagery_crs", !options.imagery.imagery_crs.empty()},
                                                {"nodata", options.imagery.nodata.has_value()},
                                                {"collar", options.imagery.collar != CollarRule::kMask},
                                                {"resampling", options.imagery.resampling != Resampling::kAuto},
                                                {"gsd_m", options.gsd_m.has_value()},
                                                {"crs", !options.crs.empty()}};
  for (const auto& [name, is_given] : given) {
    if (!is_given) continue;
    throw UsageError(std::string(name) + " is for rasters; " + plan +
                     " is a plan and has its own grid and imagery: leave it out, or give it to `pilotage tile`");
  }
}

}  // namespace pilotage
