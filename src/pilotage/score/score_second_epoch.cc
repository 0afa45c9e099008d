#include "pilotage/score/score_second_epoch.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>

#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/parallel.h"
#include "pilotage/correlation/correlation_peaks.h"
#include "pilotage/correlation/fft_correlation.h"
#include "pilotage/ground/ground_imagery.h"
#include "pilotage/raster/gray_stretch.h"
#include "pilotage/registration/register_tiles.h"
#include "pilotage/registration/surviving_features.h"
#include "pilotage/registration/warped_source.h"
#include "pilotage/score/map_strip.h"
#include "pilotage/score/tile_surfaces.h"
#include "pilotage/vision/features.h"

namespace pilotage {
namespace {

constexpr std::int64_t kGroupColumns = 64;                      // of tiles, worked on together
constexpr std::int64_t kFeatureStrip_px = 4 * kFeatureBlockPx;  // whole blocks

/// Tiles of neighbouring columns: where each stands in the result, by row, then column.
using ColumnTiles = std::map<std::int64_t, std::map<std::int64_t, std::size_t>>;

struct EpochScoring {
  const GridLevel& level;
  GraySource reference;
  GraySource second;  // drawn onto the reference
  double min_valid_fraction;
  int threads;
  double reference_center;
  double second_center;

  int radius_px() const { return std::max(level.search_radius_px, kEpochPlace_px); }
};

std::vector<ColumnTiles> group_by_columns(const TileMatrix& matrix, std::span<const std::int64_t> tile_indices) {
  std::map<std::int64_t, ColumnTiles> groups;
  for (std::size_t i = 0; i < tile_indices.size(); ++i) {
    const auto [column, row] = matrix.cell_of(tile_indices[i]);
    groups[column / kGroupColumns][row][column] = i;
  }
  std::vector<ColumnTiles> list;
  for (auto& [key, group] : groups) list.push_back(std::move(group));
  return list;
}

/// The window around tiles of a group in rows [first, last], grown by a halo and cut to the grid.
PixelWindow window_of(const TileMatrix& matrix, const ColumnTiles& group, std::int64_t first, std::int64_t last,
                      int halo) {
  std::int64_t low = matrix.matrix_width();
  std::int64_t high = -1;
  for (const auto& [row, columns] : group) {
    low = std::min(low, columns.begin()->first);
    high = std::max(high, columns.rbegin()->first);
  }
  const PixelWindow begin = matrix.search_window(low, first, halo);
  const PixelWindow end = matrix.search_window(high, last, halo);
  return {begin.col, begin.row, static_cast<int>(end.col + end.width - begin.col),
          static_cast<int>(end.row + end.height - begin.row)};
}

bool is_flat(const cv::Mat& pixels, const cv::Mat& valid) {
  double low = 0;
  double high = 0;
  cv::minMaxLoc(pixels, &low, &high, nullptr, nullptr, valid);
  return low == high;
}

/// ncc and margin of one tile.
void score_surface(const EpochScoring& scoring, const MapStrip& reference, const MapStrip& second, std::int64_t column,
                   std::int64_t row, EpochScores& score) {
  const SearchArea area(scoring.level.matrix, column, row, scoring.radius_px());
  const double least = scoring.min_valid_fraction * area.tile.width * area.tile.height;
  if (static_cast<double>(second.count_valid(area.tile)) < least ||
      static_cast<double>(reference.count_valid(area.tile)) < least) {
    return;
  }
  const cv::Mat tile = second.view(second.centred, area.tile);
  const cv::Mat tile_valid = second.view(second.valid, area.tile);
  const cv::Mat region = reference.view(reference.centred, area.window);
  if (is_flat(tile, tile_valid) ||
      is_flat(reference.view(reference.centred, area.tile), reference.view(reference.valid, area.tile))) {
    return;
  }
  const cv::Mat surface = masked_correlation_surface(
      tile, tile_valid, region, reference.view(reference.valid, area.window), scoring.min_valid_fraction);
  const cv::Rect near = cv::Rect(area.truth.x - kEpochPlace_px, area.truth.y - kEpochPlace_px, 2 * kEpochPlace_px + 1,
                                 2 * kEpochPlace_px + 1) &
                        cv::Rect(0, 0, surface.cols, surface.rows);
  cv::Mat close = surface(near).clone();
  cv::patchNaNs(close, -2);
  cv::Point best;
  cv::minMaxLoc(close, nullptr, nullptr, nullptr, &best);
  const CorrelationPeaks peaks = correlation_peaks(surface, near.tl() + best, area.tile.width);
  score.ncc = peaks.peak;
  if (scoring.level.search_radius_px > 0) score.margin = peaks.margin;
}

void score_surfaces(const EpochScoring& scoring, const ColumnTiles& group, std::vector<EpochScores>& scores) {
  const TileMatrix& matrix = scoring.level.matrix;
  std::optional<MapStrip> reference;
  std::optional<MapStrip> second;
  for (const auto& [row, columns] : group) {
    // Both strips share a window: what lies below the tiles now is read once for the rows to come.
    const PixelWindow window = window_of(matrix, group, row, row, scoring.radius_px());
    const auto move_on = [&](const GraySource& source, double center, std::optional<MapStrip>& strip) {
      MapStrip next;
      StripIntegrals integrals;
      load_strip(source, window, center, matrix.tile_size_px, 0, strip ? &*strip : nullptr, scoring.threads, integrals,
                 next);
      strip = std::move(next);
    };
    move_on(scoring.reference, scoring.reference_center, reference);
    move_on(scoring.second, scoring.second_center, second);
    const std::vector<std::pair<std::int64_t, std::size_t>> list(columns.begin(), columns.end());
    const std::int64_t tile_row = row;
    parallel_for(list.size(), scoring.threads, [&](std::size_t i, int) {
      score_surface(scoring, *reference, *second, list[i].first, tile_row, scores[list[i].second]);
    });
  }
}

struct Survival {
  std::int64_t features = 0;
  std::int64_t survive = 0;
};

/// Counts a feature for every tile of the group that it lies in.
void count_feature(const TileMatrix& matrix, const ColumnTiles& group, const Feature& feature, bool survives,
                   std::map<std::size_t, Survival>& counts) {
  const auto x = static_cast<std::int64_t>(feature.x_px);
  const auto y = static_cast<std::int64_t>(feature.y_px);
  const auto first = [&](std::int64_t position) {
    return std::max<std::int64_t>(0, (position - matrix.tile_size_px) / matrix.stride_px);
  };
  for (auto row = group.lower_bound(first(y)); row != group.end() && row->first * matrix.stride_px <= y; ++row) {
    if (y >= row->first * matrix.stride_px + matrix.tile_size_px) continue;
    for (auto tile = row->second.lower_bound(first(x));
         tile != row->second.end() && tile->first * matrix.stride_px <= x; ++tile) {
      if (x >= tile->first * matrix.stride_px + matrix.tile_size_px) continue;
      Survival& count = counts[tile->second];
      ++count.features;
      if (survives) ++count.survive;
    }
  }
}

void score_survival(const EpochScoring& scoring, const ColumnTiles& group, std::vector<EpochScores>& scores) {
  const TileMatrix& matrix = scoring.level.matrix;
  const PixelWindow all = window_of(matrix, group, group.begin()->first, group.rbegin()->first, 0);
  const std::int64_t end = all.row + all.height;
  std::map<std::size_t, Survival> counts;
  for (std::int64_t top = all.row / kFeatureStrip_px * kFeatureStrip_px; top < end; top += kFeatureStrip_px) {
    const std::int64_t first = std::max(top, all.row);
    const PixelWindow strip{all.col, first, all.width, static_cast<int>(std::min(top + kFeatureStrip_px, end) - first)};
    const FeatureSet reference = extract_features_of_map(scoring.reference, {strip}, {}, scoring.threads);
    if (reference.size() == 0) continue;
    // A feature at the strip's edge may have its counterpart just beyond.
    const auto reach = static_cast<std::int64_t>(std::ceil(kSurvivalRadiusPx));
    const std::int64_t above = std::max<std::int64_t>(0, strip.row - reach);
    const std::int64_t below = std::min(matrix.grid_height_px, strip.row + strip.height + reach);
    const FeatureSet second = extract_features_of_map(
        scoring.second, {{strip.col, above, strip.width, static_cast<int>(below - above)}}, {}, scoring.threads);
    const std::vector<std::uint8_t> survives = surviving_features(reference, second);
    const cv::Mat valid = scoring.second.read(strip).valid;
    for (std::size_t i = 0; i < reference.size(); ++i) {
      const Feature& feature = reference.features[i];
      const auto col = static_cast<int>(static_cast<std::int64_t>(feature.x_px) - strip.col);
      const auto row = static_cast<int>(static_cast<std::int64_t>(feature.y_px) - strip.row);
      if (valid.at<std::uint8_t>(row, col) == 0) continue;
      count_feature(matrix, group, feature, survives[i] != 0, counts);
    }
  }
  for (const auto& [place, count] : counts) {
    if (std::isnan(scores[place].ncc)) continue;
    scores[place].survival = static_cast<double>(count.survive) / static_cast<double>(count.features);
  }
}

void check_grid(const Crs& crs, const GeoTransform& place) {
  const bool square = place.x_per_row == 0 && place.y_per_col == 0 && place.x_per_col > 0 &&
                      std::abs(place.x_per_col + place.y_per_row) < 1e-6 * place.x_per_col;
  if (square && crs.is_projected() && crs.metres_per_unit() == 1.0) return;
  throw UsageError(
      "second_epoch needs a north-up grid of square pixels in metres, which the raster's own is not; "
      "give --gsd-m");
}

}  // namespace

std::vector<EpochScores> score_epoch_tiles(const DatePair& dates, const WarpField& field, const GridLevel& level,
                                           std::span<const std::int64_t> tile_indices, double min_valid_fraction,
                                           int threads, const Progress& progress) {
  std::vector<EpochScores> scores(tile_indices.size());
  const auto shared = std::make_shared<const WarpField>(field);
  const GraySource reference = stretch_to_8bit(dates.reference);
  const GraySource second = stretch_to_8bit(dates.second);
  const EpochScoring scoring{level,
                             reference,
                             warped_source(second, shared),
                             min_valid_fraction,
                             threads,
                             sample_map(reference, threads, progress).center,
                             sample_map(second, threads, progress).center};
  const std::vector<ColumnTiles> groups = group_by_columns(level.matrix, tile_indices);
  for (std::size_t i = 0; i < groups.size(); ++i) {
    report_progress(progress, "second epoch", static_cast<std::int64_t>(i), static_cast<std::int64_t>(groups.size()));
    score_surfaces(scoring, groups[i], scores);
    score_survival(scoring, groups[i], scores);
  }
  for (std::size_t i = 0; i < scores.size(); ++i) {
    const Eigen::Vector2d center = level.matrix.tile_bounds(level.matrix.cell_of(tile_indices[i])).center_m();
    scores[i].disagreement_m = field.displacement_m(center.x(), center.y()).norm();
  }
  return scores;
}

std::string second_date_assumption(const SecondEpoch& epoch, const RegistrationOptions& options) {
  return "of imagery and second date: " + shadows_assumption(options, epoch.registration.gsd_m);
}

SecondEpoch register_second_epoch(const Ground& ground, const ScoreOptions& options, int threads,
                                  const Progress& progress) {
  for (const GridLevel& level : ground.levels) check_grid(ground.crs, level.matrix.map_from_pixel);
  std::vector<Bounds> tiles;
  for (const GroundTile& tile : ground.tiles) tiles.push_back(ground.level_of(tile).matrix.tile_bounds(tile.cell()));
  TileRegistration registered =
      register_tiles(dataset_names(ground.imagery), ground.imagery.options, options.second_epoch, ground.crs, tiles,
                     options.registration, threads, progress);
  return {std::move(registered.registration), registered.area_m};
}

std::vector<EpochScores> score_epochs(const Ground& ground, const WarpField& field, const ScoreOptions& options,
                                      int threads, const Progress& progress) {
  std::vector<EpochScores> scores;
  const OpenPair open =
      open_rasters(dataset_names(ground.imagery), ground.imagery.options, options.second_epoch, ground.crs);
  for (const GridLevel& level : ground.levels) {
    std::vector<std::int64_t> indices;
    for (const GroundTile& tile : ground.tiles) {
      if (tile.level == level.matrix.level) indices.push_back(level.matrix.index_of(tile.column, tile.row));
    }
    if (indices.empty()) continue;
    const DatePair dates = open(level.matrix.map_from_pixel, level.matrix.grid_width_px, level.matrix.grid_height_px);
    const std::vector<EpochScores> of_level =
        score_epoch_tiles(dates, field, level, indices, options.min_valid_fraction, threads, progress);
    scores.insert(scores.end(), of_level.begin(), of_level.end());
  }
  return scores;
}

}  // namespace pilotage
