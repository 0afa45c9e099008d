#include "pilotage/score/score_ground.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include <opencv2/core.hpp>

#include "pilotage/base/parallel.h"
#include "pilotage/geo/tile_groups.h"
#include "pilotage/ground/imagery_months.h"
#include "pilotage/matchability/ground_cover.h"
#include "pilotage/matchability/reasons.h"
#include "pilotage/score/add_ground_cover.h"
#include "pilotage/score/tile_scoring.h"

namespace pilotage {
namespace {

/// Tiles of a ground ascend by level.
struct ByLevel {
  bool operator()(const GroundTile& tile, int level) const { return tile.level < level; }
  bool operator()(int level, const GroundTile& tile) const { return level < tile.level; }
};

/// The parts of a level that all measures go over before the next one is begun: what the first of them has warped, the
/// others find in memory. One part where all of the level stays there, or where each measure decodes for itself.
std::vector<std::vector<std::size_t>> parts_of_level(const Ground& ground, const TileScoring& scoring,
                                                     const ColorSource& colors, std::span<const std::int64_t> indices) {
  constexpr std::int64_t kPartHeight_px = 4096;
  const auto bytes_per_px = static_cast<std::int64_t>(CV_ELEM_SIZE(CV_MAKETYPE(colors.depth, colors.channels)) + 1);
  const std::int64_t kept_px = kImageryBytes / std::ssize(ground.levels) / bytes_per_px;
  const TileMatrix& matrix = scoring.matrix;
  const bool stays = matrix.grid_width_px * matrix.grid_height_px <= kept_px;
  if (stays || ground.imagery.own_grid)
    return tiles_by_rectangle(matrix, indices, matrix.grid_width_px, matrix.grid_height_px);
  const auto whole_blocks = [&](std::int64_t wanted_px, std::int64_t tiles) {
    const std::int64_t block_px = tiles * matrix.stride_px;
    return std::max<std::int64_t>(1, wanted_px / block_px) * block_px;
  };
  const BlockSize block = block_size(scoring);
  const std::int64_t height_px = whole_blocks(kPartHeight_px, block.rows);
  const std::int64_t part_px = kept_px / 2;  // the rest for what lies around it
  return tiles_by_rectangle(matrix, indices, whole_blocks(part_px / height_px, block.columns), height_px);
}

/// Scores the tiles of one level.
std::vector<TileScores> score_level(const Ground& ground, const GridLevel& level, const GrayAndColors& imagery,
                                    std::span<const GroundTile> tiles, const ScoreOptions& options, std::uint64_t seed,
                                    int threads, const Progress& progress) {
  std::vector<std::int64_t> indices;
  for (const GroundTile& tile : tiles) indices.push_back(level.matrix.index_of(tile.column, tile.row));
  const bool cover = options.measure(ScoreMeasure::kGroundCover);
  const double white = cover ? white_of(imagery.colors) : 0;
  TileScoring scoring =
      begin_scoring(imagery.gray, level.matrix, level.search_radius_px, options, seed, threads, progress);
  std::vector<TileScores> scores(indices.size());
  std::int64_t done = 0;
  for (const std::vector<std::size_t>& part : parts_of_level(ground, scoring, imagery.colors, indices)) {
    std::vector<std::int64_t> part_indices;
    for (const std::size_t place : part) part_indices.push_back(indices[place]);
    // Counted in tiles of the level, whatever a measure counts.
    const Progress of_level = [&](std::string_view what, std::int64_t part_done, std::int64_t part_total) {
      if (!progress || part.size() == indices.size()) return !progress || progress(what, part_done, part_total);
      const double share = part_total > 0 ? static_cast<double>(part_done) / static_cast<double>(part_total) : 0;
      return progress(what, done + std::llround(share * static_cast<double>(part.size())), std::ssize(indices));
    };
    std::vector<TileScores> of_part = score_tiles(scoring, part_indices, of_level);
    if (cover) add_ground_cover(imagery.colors, white, level.matrix, part_indices, of_part, threads, of_level);
    for (std::size_t i = 0; i < part.size(); ++i) scores[part[i]] = std::move(of_part[i]);
    done += std::ssize(part);
  }
  if (cover) add_relief(ground, tiles, scores);
  return scores;
}

}  // namespace

std::vector<TileScores> score_ground_tiles(const Ground& ground, const ScoreOptions& options,
                                           const WarpField* second_epoch, std::uint64_t seed, int threads,
                                           const Progress& progress, const GroundImagery* imagery) {
  std::optional<GroundImagery> opened;
  if (imagery == nullptr) imagery = &opened.emplace(open_imagery(ground));
  ScoreOptions of_flight = options;
  of_flight.imagery_months = imagery_months(ground);
  std::vector<TileScores> scores;
  scores.reserve(ground.tiles.size());
  for (const GridLevel& level : ground.levels) {
    const auto [first, last] =
        std::equal_range(ground.tiles.begin(), ground.tiles.end(), level.matrix.level, ByLevel{});
    if (first == last) continue;
    const GrayAndColors& of_imagery = imagery->levels[static_cast<std::size_t>(level.matrix.level)];
    std::vector<TileScores> of_level =
        score_level(ground, level, of_imagery, {first, last}, of_flight, seed, threads, progress);
    std::move(of_level.begin(), of_level.end(), std::back_inserter(scores));
  }
  if (second_epoch == nullptr) return scores;
  const std::vector<EpochScores> epochs = score_epochs(ground, *second_epoch, options, threads, progress);
  for (std::size_t i = 0; i < scores.size(); ++i) scores[i].epoch = epochs[i];
  return scores;
}

void explain_scores(const Ground& ground, std::vector<TileScores>& scores, int threads) {
  std::vector<ReasonContext> contexts;
  for (const GridLevel& level : ground.levels) contexts.push_back(reason_context(ground.crs, level));
  constexpr std::size_t kTilesAtOnce = 4096;
  parallel_for((scores.size() + kTilesAtOnce - 1) / kTilesAtOnce, threads, [&](std::size_t block, int) {
    const std::size_t end = std::min((block + 1) * kTilesAtOnce, scores.size());
    for (std::size_t i = block * kTilesAtOnce; i < end; ++i) {
      scores[i].reasons = reason_codes(scores[i], contexts[static_cast<std::size_t>(ground.tiles[i].level)]);
    }
  });
}

GroundScores score_ground(const Ground& ground, const ScoreOptions& options, std::uint64_t seed, int threads,
                          const Progress& progress, const GroundImagery* imagery) {
  GroundScores result;
  const WarpField* field = nullptr;
  if (!options.second_epoch.empty()) {
    result.second_epoch = register_second_epoch(ground, options, threads, progress);
    field = &result.second_epoch->registration.fit.field;
  }
  result.scores = score_ground_tiles(ground, options, field, seed, threads, progress, imagery);
  explain_scores(ground, result.scores, threads);
  return result;
}

}  // namespace pilotage
