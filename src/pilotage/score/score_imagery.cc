#include "pilotage/score/score_imagery.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
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

OpenImagery open_imagery(const std::vector<std::string>& datasets, const ScoreImageryOptions& options) {
  check_options(options);
  if (datasets.empty()) throw UsageError("there is no raster to score");
  std::vector<ImageryInfo> infos;
  for (const auto& dataset : datasets) infos.push_back(inspect_imagery(dataset, options.imagery));
  const bool own_grid = datasets.size() == 1 && !options.gsd_m && options.crs.empty();
  ImageryGrid grid = own_grid ? ImageryGrid{infos.front().crs, open_gray(datasets.front(), options.imagery)}
                              : resampled_grid(datasets, infos, options);
  OpenImagery imagery{datasets, own_grid, std::move(grid.crs), std::move(grid.source), {}, imagery_warnings(infos, 0)};
  imagery.matrix = score_matrix(imagery.source, options.grid);
  return imagery;
}

SecondEpoch register_second_epoch(const OpenImagery& imagery, const ScoreImageryOptions& options, int threads,
                                  const Progress& progress) {
  EpochTiles all{imagery.matrix, options.grid.search_radius_px, {}};
  all.indices.resize(static_cast<std::size_t>(imagery.matrix.tile_count()));
  std::iota(all.indices.begin(), all.indices.end(), 0);
  return register_epochs({imagery.datasets, options.imagery, imagery.crs}, {all}, options.score, threads, progress);
}

std::vector<TileScore> score_imagery_tiles(const OpenImagery& imagery, const ScoreImageryOptions& options,
                                           const std::vector<std::int64_t>& indices, const WarpField* second_epoch,
                                           std::uint64_t seed, int threads, const Progress& progress) {
  std::vector<TileScore> scores = score_tiles(imagery.source, imagery.matrix, options.grid.search_radius_px, indices,
                                              options.score, seed, threads, progress);
  if (second_epoch != nullptr) {
    EpochTiles tiles{imagery.matrix, options.grid.search_radius_px, {}};
    for (const TileScore& score : scores) tiles.indices.push_back(score.tile_id);
    const std::vector<EpochScores> epochs = score_epochs({imagery.datasets, options.imagery, imagery.crs},
                                                         *second_epoch, {tiles}, options.score, threads, progress);
    for (std::size_t i = 0; i < scores.size(); ++i) scores[i].epoch = epochs[i];
  }
  if (options.score.measure(ScoreMeasure::kGroundCover)) {
    const GraySource& source = imagery.source;
    const ColorSource colors = imagery.own_grid
                                   ? open_colors(imagery.datasets.front(), options.imagery)
                                   : open_colors_on_grid(imagery.datasets, imagery.crs, source.map_from_pixel,
                                                         source.width_px, source.height_px, options.imagery);
    add_ground_cover(colors, imagery.matrix, scores, threads, progress);
  }
  return scores;
}

std::vector<TileRow> imagery_rows(const OpenImagery& imagery, std::vector<TileScore> scores, int threads) {
  return make_rows(imagery.matrix, imagery.crs, scores, threads);
}

ScoredImagery score_imagery(const std::vector<std::string>& datasets, const ScoreImageryOptions& options,
                            std::uint64_t seed, int threads, const Progress& progress) {
  OpenImagery imagery = open_imagery(datasets, options);
  ScoredImagery result{imagery.crs, imagery.matrix, {}, imagery.warnings, {}};
  const WarpField* field = nullptr;
  if (!options.score.second_epoch.empty()) {
    result.second_epoch = register_second_epoch(imagery, options, threads, progress);
    field = &result.second_epoch->registration.fit.field;
  }
  std::vector<TileScore> scores = score_imagery_tiles(imagery, options, {}, field, seed, threads, progress);
  for (const TileScore& score : scores) {
    if (result.second_epoch) result.second_epoch->scores.push_back(score.epoch);
  }
  imagery.source.read = {};  // gives the decoded blocks back that GDAL holds: rows take their memory
  result.rows = imagery_rows(imagery, std::move(scores), threads);
  return result;
}

}  // namespace pilotage
