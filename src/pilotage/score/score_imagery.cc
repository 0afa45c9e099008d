#include "pilotage/score/score_imagery.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "pilotage/base/error.h"
#include "pilotage/base/parallel.h"
#include "pilotage/base/text.h"
#include "pilotage/matchability/reasons.h"
#include "pilotage/raster/gdal_io.h"
#include "pilotage/raster/mission_crs.h"
#include "pilotage/score/add_ground_cover.h"

namespace pilotage {
namespace {

struct ImageryGrid {
  Crs crs;
  GraySource source;
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

ImageryGrid resampled_grid(const std::vector<std::string>& datasets, const std::vector<ImageryInfo>& infos,
                           const ScoreImageryOptions& options) {
  if (!options.gsd_m) {
    throw UsageError(datasets.size() > 1 ? "several rasters need a common grid; give --gsd-m" : "--crs needs --gsd-m");
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
  return {crs,
          open_gray_on_grid(datasets, crs, GeoTransform::north_up(min_x_m, max_y_m, gsd_m),
                            static_cast<std::int64_t>(std::ceil((bounds.max_x_m - min_x_m) / gsd_m)),
                            static_cast<std::int64_t>(std::ceil((max_y_m - bounds.min_y_m) / gsd_m)), options.imagery)};
}

// The rectangle around a tile, its axes in metres; NaN where the CRS counts degrees.
Bounds tile_bounds(const TileMatrix& matrix, const PixelWindow& window, double metres_per_unit) {
  Bounds bounds;
  for (const int row : {0, window.height}) {
    for (const int col : {0, window.width}) {
      bounds.extend(matrix.map_from_pixel.map_from_pixel(
                        {static_cast<double>(window.col + col), static_cast<double>(window.row + row)}) *
                    metres_per_unit);
    }
  }
  if (std::isnan(metres_per_unit)) {
    bounds = {metres_per_unit, metres_per_unit, metres_per_unit, metres_per_unit};
  }
  return bounds;
}

TileRow make_row(const TileMatrix& matrix, TileScore& score, double metres_per_unit, const CrsTransform& transform) {
  constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();
  const PixelWindow window = matrix.tile_window(score.column, score.row);
  TileRow row;
  row.tile.tile_id = score.tile_id;
  row.tile.column = score.column;
  row.tile.row = score.row;
  row.tile.bounds = tile_bounds(matrix, window, metres_per_unit);
  const Eigen::Vector2d center = matrix.map_from_pixel.map_from_pixel(
      {static_cast<double>(window.col) + window.width / 2.0, static_cast<double>(window.row) + window.height / 2.0});
  row.tile.center = transform.geodetic_from_map(center).value_or(GeodeticPoint{kNowhere, kNowhere});
  row.tile.valid_fraction = score.valid_fraction;
  row.min_col_px = window.col;
  row.min_row_px = window.row;
  row.score = std::move(score);
  return row;
}

/// Rows with places and reasons of all scores, which are moved out.
std::vector<TileRow> make_rows(const TileMatrix& matrix, const Crs& crs, std::span<TileScore> scores, int threads) {
  constexpr std::size_t kRowsAtOnce = 4096;
  const double metres_per_unit = crs.metres_per_unit();
  std::vector<std::optional<CrsTransform>> transforms(static_cast<std::size_t>(thread_count(threads)));
  std::vector<TileRow> rows(scores.size());
  parallel_for((scores.size() + kRowsAtOnce - 1) / kRowsAtOnce, threads, [&](std::size_t piece, int worker) {
    std::optional<CrsTransform>& transform = transforms[static_cast<std::size_t>(worker)];
    if (!transform) transform.emplace(crs);
    const std::size_t first = piece * kRowsAtOnce;
    const std::span<TileScore> part = scores.subspan(first, std::min(kRowsAtOnce, scores.size() - first));
    explain_tiles({matrix, metres_per_unit}, part);
    for (std::size_t i = 0; i < part.size(); ++i) {
      rows[first + i] = make_row(matrix, part[i], metres_per_unit, *transform);
    }
  });
  return rows;
}

}  // namespace

ScoredImagery score_imagery(const std::vector<std::string>& datasets, const ScoreImageryOptions& options,
                            std::uint64_t seed, int threads, const Progress& progress) {
  check_options(options);
  if (datasets.empty()) throw UsageError("there is no raster to score");
  std::vector<ImageryInfo> infos;
  for (const auto& dataset : datasets) infos.push_back(inspect_imagery(dataset, options.imagery));

  const bool own_grid = datasets.size() == 1 && !options.gsd_m && options.crs.empty();
  ImageryGrid grid = own_grid ? ImageryGrid{infos.front().crs, open_gray(datasets.front(), options.imagery)}
                              : resampled_grid(datasets, infos, options);
  ScoredImagery result;
  result.crs = grid.crs;
  result.matrix = score_matrix(grid.source, options.grid);
  result.warnings = imagery_warnings(infos, 0);
  std::vector<TileScore> scores = score_tiles(grid.source, result.matrix, options.grid.search_radius_px, {},
                                              options.score, seed, threads, progress);
  if (!options.score.second_epoch.empty()) {
    EpochTiles all{result.matrix, options.grid.search_radius_px, {}};
    for (const TileScore& score : scores) all.indices.push_back(score.tile_id);
    result.second_epoch = compare_epochs(datasets, options.imagery, grid.crs, {all}, options.score, threads, progress);
    for (std::size_t i = 0; i < scores.size(); ++i) scores[i].epoch = result.second_epoch->scores[i];
  }
  if (options.score.measure(ScoreMeasure::kGroundCover)) {
    const ColorSource colors = own_grid
                                   ? open_colors(datasets.front(), options.imagery)
                                   : open_colors_on_grid(datasets, grid.crs, grid.source.map_from_pixel,
                                                         grid.source.width_px, grid.source.height_px, options.imagery);
    add_ground_cover(colors, result.matrix, scores, threads, progress);
  }
  grid.source.read = {};  // gives the decoded blocks back that GDAL holds: rows take their memory
  result.rows = make_rows(result.matrix, grid.crs, scores, threads);
  return result;
}

}  // namespace pilotage
