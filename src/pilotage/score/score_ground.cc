#include "pilotage/score/score_ground.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <span>

#include "pilotage/base/parallel.h"
#include "pilotage/ground/imagery_months.h"
#include "pilotage/matchability/reasons.h"
#include "pilotage/score/add_ground_cover.h"

namespace pilotage {
namespace {

/// Tiles of a ground ascend by level.
struct ByLevel {
  bool operator()(const GroundTile& tile, int level) const { return tile.level < level; }
  bool operator()(int level, const GroundTile& tile) const { return level < tile.level; }
};

/// Scores the tiles of one level.
std::vector<TileScores> score_level(const Ground& ground, const GridLevel& level, const GrayAndColors& imagery,
                                    std::span<const GroundTile> tiles, const ScoreOptions& options, std::uint64_t seed,
                                    int threads, const Progress& progress) {
  std::vector<std::int64_t> indices;
  for (const GroundTile& tile : tiles) indices.push_back(level.matrix.index_of(tile.column, tile.row));
  std::vector<TileScores> scores =
      score_tiles(imagery.gray, level.matrix, level.search_radius_px, indices, options, seed, threads, progress);
  if (options.measure(ScoreMeasure::kGroundCover)) {
    add_ground_cover(imagery.colors, level.matrix, indices, scores, threads, progress);
    add_relief(ground, tiles, scores);
  }
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
