#include "pilotage/score/tile_scoring.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <future>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/parallel.h"
#include "pilotage/correlation/correlation_peaks.h"
#include "pilotage/matchability/fine_contrast.h"
#include "pilotage/raster/gray_stretch.h"
#include "pilotage/score/map_strip.h"
#include "pilotage/score/predict_correct_fixes.h"
#include "pilotage/score/tile_statistics.h"
#include "pilotage/score/tile_surfaces.h"

namespace pilotage {
namespace {

/// Memory for spectra and surfaces of the tile columns that are worked on together, and how many these are at most.
constexpr std::size_t kColumnMemory = std::size_t{400} << 20;
constexpr std::int64_t kMostColumns = 64;
/// Pixels of a strip: the map is held in memory in blocks of about this size (twice: one is read while one is worked
/// on).
constexpr std::int64_t kStripPixels = 8 << 20;

/// The scoring of the tiles of one call.
struct TilesInWork : TileScoring {
  std::span<const std::int64_t> indices;  // ascending

  std::size_t place_of(std::int64_t index) const {
    return static_cast<std::size_t>(std::lower_bound(indices.begin(), indices.end(), index) - indices.begin());
  }
};

/// Tiles of a few columns and a few rows: what is worked on with one strip in memory.
struct TileBlock {
  std::int64_t first_column = 0;
  std::int64_t columns = 0;
  PixelWindow window;
  std::map<std::int64_t, std::vector<std::int64_t>> columns_of_row;  // tiles asked for
};

void check_request(const GraySource& source, const TileMatrix& matrix, int search_radius_px,
                   std::span<const std::int64_t> tile_indices, const ScoreOptions& options) {
  check_options(options);
  if (options.measures.empty()) throw UsageError("measures: none is asked for");
  if (search_radius_px < 0) {
    throw UsageError("search_radius_px = " + std::to_string(search_radius_px) + " is negative");
  }
  if (options.measures_surface() && search_radius_px == 0) {
    throw UsageError("search_radius_px = 0: uniqueness and degraded need room to search, at least 1 px");
  }
  if (matrix.tile_size_px < 1 || matrix.stride_px < 1) throw UsageError("tile size and stride must be at least 1 px");
  if (matrix.grid_width_px != source.width_px || matrix.grid_height_px != source.height_px) {
    throw DataError("the tile matrix is that of a grid of " + std::to_string(matrix.grid_width_px) + " x " +
                    std::to_string(matrix.grid_height_px) + " px, the imagery has " + std::to_string(source.width_px) +
                    " x " + std::to_string(source.height_px) + " px");
  }
  if (matrix.tile_count() == 0) {
    throw DataError("a tile of " + std::to_string(matrix.tile_size_px) + " x " + std::to_string(matrix.tile_size_px) +
                    " px is larger than the imagery of " + std::to_string(source.width_px) + " x " +
                    std::to_string(source.height_px) + " px");
  }
  std::int64_t before = -1;
  for (const std::int64_t index : tile_indices) {
    if (index < 0 || index >= matrix.tile_count()) {
      throw UsageError("tile index " + std::to_string(index) + " is outside [0, " +
                       std::to_string(matrix.tile_count() - 1) + "]");
    }
    if (index <= before) {
      throw UsageError("tile index " + std::to_string(index) + " follows " + std::to_string(before) +
                       ": indices must ascend, without duplicates");
    }
    before = index;
  }
}

std::int64_t columns_per_block(const TileScoring& scoring) {
  std::size_t bytes = 1;
  if (scoring.clean()) bytes += CleanSurfaces::bytes_per_column(scoring.matrix, scoring.radius_px, scoring.lag_step);
  if (scoring.degraded()) bytes += DegradedSurfaces::bytes_per_column(scoring.matrix, scoring.radius_px);
  return std::clamp<std::int64_t>(static_cast<std::int64_t>(kColumnMemory / bytes), 1, kMostColumns);
}

int halo_px(const TileScoring& scoring) {
  return std::max(scoring.radius_px, scoring.margin_px);
}

/// The blocks that hold a tile that is asked for: down one group of columns, then the next. Their borders do not depend
/// on which tiles are asked for.
std::vector<TileBlock> make_blocks(const TilesInWork& scoring) {
  const TileMatrix& matrix = scoring.matrix;
  const auto [columns, rows] = block_size(scoring);
  const int halo = halo_px(scoring);
  std::map<std::pair<std::int64_t, std::int64_t>, TileBlock> blocks;
  for (const std::int64_t index : scoring.indices) {
    const auto [column, row] = matrix.cell_of(index);
    TileBlock& block = blocks[{column / columns, row / rows}];
    block.columns_of_row[row].push_back(column);
    if (block.columns > 0) continue;
    block.first_column = column / columns * columns;
    block.columns = std::min(columns, matrix.matrix_width() - block.first_column);
    const std::int64_t first_row = row / rows * rows;
    const std::int64_t last_row = std::min(first_row + rows, matrix.matrix_height()) - 1;
    const PixelWindow first = matrix.search_window(block.first_column, first_row, halo);
    const PixelWindow last = matrix.search_window(block.first_column + block.columns - 1, last_row, halo);
    block.window = {first.col, first.row, static_cast<int>(last.col + last.width - first.col),
                    static_cast<int>(last.row + last.height - first.row)};
  }
  std::vector<TileBlock> list;
  for (auto& [key, block] : blocks) list.push_back(std::move(block));
  return list;
}

/// V and H of a block's tiles, and their status.
void score_block_statistics(const TilesInWork& scoring, const TileBlock& block, const MapStrip& strip,
                            std::vector<TileScores>& scores) {
  std::vector<MeasuredTile> tiles;
  for (const auto& [row, columns] : block.columns_of_row) {
    for (const std::int64_t column : columns) {
      tiles.push_back({{column, row}, &scores[scoring.place_of(scoring.matrix.index_of(column, row))]});
    }
  }
  score_statistics({strip.window, strip.pixels, strip.valid}, scoring.matrix, scoring.options, tiles, scoring.threads);
}

SurfaceScores surface_scores(const CorrelationPeaks& peaks) {
  return {peaks.peak,        peaks.rival,      peaks.margin,        peaks.rival_ratio,
          peaks.psr,         peaks.rivals,     peaks.half_width_px, peaks.expected_error_px,
          peaks.rival_dx_px, peaks.rival_dy_px};
}

/// Mean of what is defined over the copies; the rival's place is that of the copy with the smallest margin.
SurfaceScores mean_scores(const std::vector<SurfaceScores>& copies) {
  SurfaceScores result;
  for (double SurfaceScores::*const member : {&SurfaceScores::peak, &SurfaceScores::rival, &SurfaceScores::margin,
                                              &SurfaceScores::rival_ratio, &SurfaceScores::psr, &SurfaceScores::rivals,
                                              &SurfaceScores::half_width_px, &SurfaceScores::expected_error_px}) {
    double sum = 0;
    int count = 0;
    for (const SurfaceScores& copy : copies) {
      if (std::isnan(copy.*member)) continue;
      sum += copy.*member;
      ++count;
    }
    if (count > 0) result.*member = sum / count;
  }
  double smallest = std::numeric_limits<double>::infinity();
  for (const SurfaceScores& copy : copies) {
    if (!(copy.margin < smallest)) continue;
    smallest = copy.margin;
    result.rival_dx_px = copy.rival_dx_px;
    result.rival_dy_px = copy.rival_dy_px;
  }
  return result;
}

/// A tile whose search area is not all ground: masked correlation. The mask of a degraded copy loses a border as wide
/// as the copy may have moved, so that what it shows is ground.
void score_masked(const TileScoring& scoring, const MapStrip& strip, const SearchArea& area, TileScores& score) {
  const cv::Mat tile = strip.view(strip.centred, area.tile);
  const cv::Mat tile_valid = strip.view(strip.valid, area.tile);
  const cv::Mat region = strip.view(strip.centred, area.window);
  const cv::Mat region_valid = strip.view(strip.valid, area.window);
  const auto surfaces_of = [&](const cv::Mat& valid) {
    return masked_surfaces(valid, region, region_valid, scoring.options.min_valid_fraction);
  };
  const auto scores_of = [&](const cv::Mat& surface) {
    return surface_scores(correlation_peaks(surface, area.truth, area.tile.width));
  };
  if (scoring.clean()) score.clean = scores_of(surfaces_of(tile_valid)(tile));
  if (!scoring.degraded()) return;
  cv::Mat kept = tile_valid.clone();
  if (cv::countNonZero(tile_valid) < tile_valid.rows * tile_valid.cols) {
    const int side = 2 * scoring.margin_px + 1;
    cv::erode(tile_valid, kept, cv::Mat::ones(side, side, CV_8U), {-1, -1}, 1, cv::BORDER_REPLICATE);
  }
  if (cv::countNonZero(kept) < 2) return;
  const auto surface_of = surfaces_of(kept);
  std::vector<SurfaceScores> copies;
  for (const Degrader& degrader : scoring.copies) {
    copies.push_back(scores_of(surface_of(degraded_tile(strip, area.tile, degrader, scoring.margin_px))));
  }
  score.degraded = mean_scores(copies);
}

/// Neighbouring tile columns of a block and of those below it, for one thread: what they share they compute once.
struct ColumnGroup {
  std::int64_t first_column = 0;
  std::int64_t columns = 0;
  std::optional<CleanSurfaces> clean;
  std::optional<DegradedSurfaces> degraded;
  SurfaceScratch scratch;
  std::vector<std::int64_t> masked;  // tile indices that are left for score_masked
};

/// Groups for the blocks that follow each other down one set of columns, with about as many tiles each. Groups compute
/// what lies across their borders twice, so they are not cut finer than the threads need.
std::vector<std::unique_ptr<ColumnGroup>> make_groups(const TileScoring& scoring, std::span<const TileBlock> blocks) {
  const TileBlock& first = blocks.front();
  std::vector<std::size_t> tiles(static_cast<std::size_t>(first.columns), 0);
  std::size_t total = 0;
  for (const TileBlock& block : blocks) {
    if (block.first_column != first.first_column) break;
    for (const auto& [row, columns] : block.columns_of_row) {
      total += columns.size();
      for (const std::int64_t column : columns) ++tiles[static_cast<std::size_t>(column - first.first_column)];
    }
  }
  const std::int64_t least = 2 * BlockSums::blocks_per_side(scoring.matrix);
  const auto wanted = static_cast<std::size_t>(std::clamp<std::int64_t>(first.columns / least, 1, scoring.threads));
  std::vector<std::unique_ptr<ColumnGroup>> groups;
  std::size_t before = 0;
  std::int64_t begin = 0;
  for (std::int64_t column = 0; column < first.columns; ++column) {
    before += tiles[static_cast<std::size_t>(column)];
    const bool last = column + 1 == first.columns;
    if (!last && before * wanted < total * (groups.size() + 1)) continue;
    auto group = std::make_unique<ColumnGroup>();
    group->first_column = first.first_column + begin;
    group->columns = column + 1 - begin;
    if (scoring.clean()) {
      group->clean.emplace(scoring.matrix, scoring.radius_px, scoring.lag_step, group->first_column, group->columns);
    }
    if (scoring.degraded()) {
      group->degraded.emplace(scoring.matrix, scoring.radius_px, group->first_column, group->columns, scoring.copies,
                              scoring.margin_px);
    }
    groups.push_back(std::move(group));
    begin = column + 1;
  }
  return groups;
}

/// Surfaces of the tiles of one row that belong to a group, but for those that need masks. Ends early when `go_on`,
/// asked before each tile, says so.
void score_row(const TilesInWork& scoring, const MapStrip& strip, std::int64_t row, std::span<const std::int64_t> asked,
               const std::function<bool()>& go_on, ColumnGroup& group, std::vector<TileScores>& scores) {
  std::vector<std::int64_t> whole;  // search area all ground
  for (const std::int64_t column : asked) {
    const std::int64_t index = scoring.matrix.index_of(column, row);
    if (scores[scoring.place_of(index)].status != TileStatus::kScored) continue;
    const SearchArea area(scoring.matrix, column, row, scoring.radius_px);
    const std::int64_t pixels = static_cast<std::int64_t>(area.window.width) * area.window.height;
    if (strip.count_valid(area.window) == pixels) {
      whole.push_back(column);
    } else {
      group.masked.push_back(index);
    }
  }
  if (whole.empty()) return;
  if (group.clean) group.clean->prepare(strip, row, whole);
  for (const std::int64_t column : whole) {
    if (!go_on()) return;
    const SearchArea area(scoring.matrix, column, row, scoring.radius_px);
    TileScores& score = scores[scoring.place_of(scoring.matrix.index_of(column, row))];
    if (group.clean) score.clean = surface_scores(group.clean->peaks(strip, area, column, row, group.scratch));
    if (!group.degraded) continue;
    std::vector<SurfaceScores> copies;
    for (const auto& peaks : group.degraded->peaks(strip, area, column, row)) {
      copies.push_back(peaks ? surface_scores(*peaks) : SurfaceScores{});
    }
    score.degraded = mean_scores(copies);
  }
}

/// Surfaces of the tiles of a block; `advance(n)` says that n more are done and returns false to stop.
void score_surfaces(const TilesInWork& scoring, const TileBlock& block, const MapStrip& strip,
                    std::span<const std::unique_ptr<ColumnGroup>> groups,
                    const std::function<bool(std::int64_t)>& advance, std::vector<TileScores>& scores) {
  std::atomic<bool> stopped{false};
  const std::function<bool()> go_on = [&] {
    if (!stopped && !advance(0)) stopped = true;
    return !stopped;
  };
  parallel_for(groups.size(), scoring.threads, [&](std::size_t index, int) {
    ColumnGroup& group = *groups[index];
    group.masked.clear();
    for (const auto& [row, columns] : block.columns_of_row) {
      const auto first = std::lower_bound(columns.begin(), columns.end(), group.first_column);
      const auto last = std::lower_bound(first, columns.end(), group.first_column + group.columns);
      score_row(scoring, strip, row, {first, last}, go_on, group, scores);
      if (stopped) return;
      if (!advance(last - first)) stopped = true;
    }
  });
  if (stopped) throw Interrupted{};
  std::vector<std::int64_t> masked;
  for (const auto& group : groups) masked.insert(masked.end(), group->masked.begin(), group->masked.end());
  parallel_for(masked.size(), scoring.threads, [&](std::size_t i, int) {
    if (!go_on()) return;
    const auto [column, row] = scoring.matrix.cell_of(masked[i]);
    const SearchArea area(scoring.matrix, column, row, scoring.radius_px);
    score_masked(scoring, strip, area, scores[scoring.place_of(masked[i])]);
  });
  if (stopped) throw Interrupted{};
}

void load(const TileScoring& scoring, const TileBlock& block, const MapStrip* previous, StripIntegrals& integrals,
          MapStrip& strip) {
  load_strip(scoring.source, block.window, scoring.center, scoring.matrix.tile_size_px, scoring.lag_step, previous,
             scoring.threads, integrals, strip);
}

/// Statistics and surfaces of all tiles, block by block; the next block is read while one is worked on.
void score_blocks(const TilesInWork& scoring, const Progress& progress, std::vector<TileScores>& scores) {
  const std::vector<TileBlock> blocks = make_blocks(scoring);
  std::vector<std::unique_ptr<ColumnGroup>> groups;
  std::mutex progress_mutex;
  std::int64_t done = 0;
  const auto advance = [&](std::int64_t tiles) {
    const std::lock_guard lock(progress_mutex);
    done += tiles;
    return !progress || progress("score", done, static_cast<std::int64_t>(scores.size()));
  };
  if (!advance(0)) throw Interrupted{};
  MapStrip strip;
  MapStrip next_strip;
  StripIntegrals integrals;
  load(scoring, blocks.front(), nullptr, integrals, strip);
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const TileBlock& block = blocks[i];
    std::future<void> next;  // read while this block is worked on
    if (i + 1 < blocks.size()) {
      next = std::async(std::launch::async, [&, i] { load(scoring, blocks[i + 1], &strip, integrals, next_strip); });
    }
    if (i == 0 || blocks[i - 1].first_column != block.first_column) {
      groups = make_groups(scoring, std::span(blocks).subspan(i));
    }
    score_block_statistics(scoring, block, strip, scores);
    score_surfaces(scoring, block, strip, groups, advance, scores);
    if (!next.valid()) continue;
    next.get();
    std::swap(strip, next_strip);
  }
}

}  // namespace

bool TileScoring::clean() const {
  return options.measure(ScoreMeasure::kUniqueness);
}
bool TileScoring::degraded() const {
  return options.measure(ScoreMeasure::kDegraded);
}

BlockSize block_size(const TileScoring& scoring) {
  if (!scoring.options.measures_surface()) return {1, 1};
  const TileMatrix& matrix = scoring.matrix;
  const std::int64_t columns = columns_per_block(scoring);
  const int around_px = matrix.tile_size_px + 2 * halo_px(scoring);
  const std::int64_t width_px = (columns - 1) * matrix.stride_px + around_px;
  const std::int64_t rows = (kStripPixels / width_px - around_px) / matrix.stride_px + 1;
  return {columns, std::max<std::int64_t>(1, rows)};
}

TileScoring begin_scoring(const GraySource& source, const TileMatrix& matrix, int search_radius_px,
                          std::span<const std::int64_t> tile_indices, const ScoreOptions& options, std::uint64_t seed,
                          int threads, const Progress& progress) {
  check_request(source, matrix, search_radius_px, tile_indices, options);
  TileScoring scoring{source, matrix, options, options.measures_surface() ? search_radius_px : 0,
                      thread_count(threads)};
  if (options.measure(ScoreMeasure::kCorrectFix)) {  // a wrong model is refused before the work is done
    scoring.model = model_for(options);
    // The map's features are found in 8 bits, and the contrast that they have is what counts.
    scoring.shown = stretch_to_8bit(source);
  }
  if (scoring.degraded()) {
    scoring.margin_px = rotation_margin_px(matrix.tile_size_px, options.degradation);
    for (int copy = 0; copy < options.degraded_copies; ++copy) {
      scoring.copies.emplace_back(matrix.tile_size_px, scoring.margin_px, options.degradation, seed, copy);
    }
  }
  if (options.measures_surface()) {
    const MapSample sample = sample_map(source, scoring.threads, progress);
    scoring.center = sample.center;
    scoring.lag_step =
        options.every_lag || !scoring.clean() ? 1 : choose_lag_step(sample, matrix.tile_size_px, scoring.radius_px);
  }
  if (scoring.model) {
    scoring.usual_contrast = options.usual_fine_contrast
                                 ? *options.usual_fine_contrast
                                 : usual_fine_contrast(scoring.shown, matrix.tile_size_px, scoring.threads, progress);
  }
  return scoring;
}

std::vector<TileScores> score_tiles(const TileScoring& scoring, std::span<const std::int64_t> tile_indices,
                                    const Progress& progress) {
  std::vector<TileScores> scores(tile_indices.size());
  if (scores.empty()) return scores;
  if (scoring.options.measures_surface()) {
    score_blocks({scoring, tile_indices}, progress, scores);
  } else {
    std::vector<MeasuredTile> tiles;
    for (std::size_t i = 0; i < scores.size(); ++i)
      tiles.push_back({scoring.matrix.cell_of(tile_indices[i]), &scores[i]});
    stream_statistics(scoring.source, scoring.matrix, scoring.options, tiles, scoring.threads, progress);
  }
  if (scoring.model) {
    predict_correct_fixes(scoring.shown, scoring.matrix, scoring.options, *scoring.model, tile_indices, scores,
                          scoring.usual_contrast, scoring.threads, progress);
  }
  return scores;
}

}  // namespace pilotage
