#include "pilotage/score/score_ground.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "pilotage/base/parallel.h"
#include "pilotage/geo/tile_groups.h"
#include "pilotage/ground/imagery_months.h"
#include "pilotage/matchability/reasons.h"
#include "pilotage/matchability/self_votes.h"
#include "pilotage/score/add_ground_cover.h"
#include "pilotage/score/tile_scoring.h"
#include "pilotage/vision/features.h"

namespace pilotage {
namespace {

/// Tiles of a ground ascend by level.
struct ByLevel {
  bool operator()(const GroundTile& tile, int level) const { return tile.level < level; }
  bool operator()(int level, const GroundTile& tile) const { return level < tile.level; }
};

/// How many times the tiles are gone over: for their statistics and surfaces; for P by their fine contrast and their
/// features; for their ground cover.
int count_passes(const ScoreOptions& options) {
  return 1 + (options.measure(ScoreMeasure::kCorrectFix) ? 2 : 0) +
         (options.measure(ScoreMeasure::kGroundCover) ? 1 : 0);
}

/// The pixels around a tile that some measure reads.
int reach_px(const TileScoring& scoring) {
  const int of_features = scoring.model ? kVoteReach_px + kFeatureBlockPx : 0;  // found in whole blocks
  return std::max({scoring.radius_px, scoring.margin_px, of_features});
}

/// How many pixels stay in memory when all that tiles need is read: blocks of this size.
constexpr int kUnitWidth_px = 512;
constexpr int kUnitHeight_px = 256;
std::int64_t needed_pixels(const TileScoring& scoring, std::span<const std::int64_t> indices) {
  const TileMatrix& matrix = scoring.matrix;
  const std::int64_t across = matrix.grid_width_px / kUnitWidth_px + 1;
  std::vector<char> needed(static_cast<std::size_t>(across * (matrix.grid_height_px / kUnitHeight_px + 1)), 0);
  for (const std::int64_t index : indices) {
    const PixelWindow window = matrix.search_window(matrix.cell_of(index), reach_px(scoring));
    const std::int64_t first = window.col / kUnitWidth_px;
    const std::int64_t last = (window.col + window.width - 1) / kUnitWidth_px;
    for (std::int64_t row = window.row / kUnitHeight_px; row * kUnitHeight_px < window.row + window.height; ++row) {
      std::fill_n(needed.begin() + row * across + first, last - first + 1, char{1});
    }
  }
  return std::count(needed.begin(), needed.end(), char{1}) * kUnitWidth_px * kUnitHeight_px;
}

/// The parts of a level (places in `indices`) that all measures go over before the next one is begun: what the first of
/// them has warped, the others find in memory. Whole blocks of tiles, and as large as will stay with what lies around
/// them. One part where all stays, where so little would that what lies around is more, and for a single pass.
std::vector<std::vector<std::size_t>> parts_of_level(const TileScoring& scoring, std::int64_t kept_px,
                                                     std::span<const std::int64_t> indices) {
  const TileMatrix& matrix = scoring.matrix;
  const auto one_part = [&] {
    std::vector<std::size_t> all(indices.size());
    std::iota(all.begin(), all.end(), 0U);
    return std::vector<std::vector<std::size_t>>{all};
  };
  if (kept_px == 0 || count_passes(scoring.options) < 2 || needed_pixels(scoring, indices) <= kept_px) {
    return one_part();
  }
  const std::int64_t around_px = matrix.tile_size_px + 2 * (reach_px(scoring) + kUnitWidth_px);
  const BlockSize block = block_size(scoring);
  const auto whole_blocks = [&](std::int64_t room_px, std::int64_t tiles) {
    return std::max<std::int64_t>(1, room_px / (tiles * matrix.stride_px)) * tiles * matrix.stride_px;
  };
  // As wide as high, or as the grid is narrower or lower than that.
  const auto side_px = static_cast<std::int64_t>(std::sqrt(static_cast<double>(kept_px)));
  const std::int64_t across_px = std::max(side_px, kept_px / matrix.grid_height_px);
  const std::int64_t width_px =
      across_px >= matrix.grid_width_px ? matrix.grid_width_px : whole_blocks(across_px - around_px, block.columns);
  const std::int64_t down_px = kept_px / std::min(width_px + around_px, matrix.grid_width_px);
  if (down_px >= matrix.grid_height_px) {
    return tiles_by_rectangle(matrix, indices, width_px, matrix.grid_height_px);
  }
  const std::int64_t room_px = down_px - around_px;
  if (room_px < std::max(around_px, block.rows * matrix.stride_px)) return one_part();
  return tiles_by_rectangle(matrix, indices, width_px, whole_blocks(room_px, block.rows));
}

/// Progress of a level in tiles, whatever a measure counts and in however many parts: each measure of a part is its
/// share of these tiles, so that the count only grows. One part is told as its measures tell it.
class LevelProgress {
 public:
  LevelProgress(const Progress& progress, std::size_t tiles, int passes)
      : progress_(progress), tiles_(static_cast<double>(tiles)), passes_(passes) {}

  void begin_part(std::size_t tiles) {
    done_ += part_;
    part_ = static_cast<double>(tiles);
    pass_ = -1;
    what_.clear();
  }

  bool tell(std::string_view what, std::int64_t done, std::int64_t total) {
    if (!progress_) return true;
    if (part_ == tiles_) return progress_(what, done, total);
    if (what != what_) {
      what_ = what;
      ++pass_;
    }
    const double share = total > 0 ? static_cast<double>(done) / static_cast<double>(total) : 0;
    const double of_part = std::min(1.0, (pass_ + share) / passes_);
    return progress_(what, std::llround(done_ + of_part * part_), std::llround(tiles_));
  }

 private:
  const Progress& progress_;
  double tiles_;
  int passes_;
  double done_ = 0;  // tiles of the parts before
  double part_ = 0;
  int pass_ = -1;
  std::string what_;
};

/// Scores the tiles of one level.
std::vector<TileScores> score_level(const Ground& ground, const GridLevel& level, const GrayAndColors& imagery,
                                    std::span<const GroundTile> tiles, const ScoreOptions& options, std::uint64_t seed,
                                    int threads, const Progress& progress) {
  std::vector<std::int64_t> indices;
  for (const GroundTile& tile : tiles) indices.push_back(level.matrix.index_of(tile.column, tile.row));
  const bool cover = options.measure(ScoreMeasure::kGroundCover);
  const TileScoring scoring =
      begin_scoring(imagery.gray, level.matrix, level.search_radius_px, indices, options, seed, threads, progress);
  std::optional<double> white;
  std::vector<TileScores> scores(indices.size());
  LevelProgress level_progress(progress, indices.size(), count_passes(options));
  const Progress tell = [&](std::string_view what, std::int64_t done, std::int64_t total) {
    return level_progress.tell(what, done, total);
  };
  for (const std::vector<std::size_t>& part : parts_of_level(scoring, imagery.kept_px, indices)) {
    std::vector<std::int64_t> part_indices;
    for (const std::size_t place : part) part_indices.push_back(indices[place]);
    level_progress.begin_part(part.size());
    std::vector<TileScores> of_part = score_tiles(scoring, part_indices, tell);
    if (cover) add_ground_cover(imagery.colors, white, level.matrix, part_indices, of_part, threads, tell);
    for (std::size_t i = 0; i < part.size(); ++i) scores[part[i]] = std::move(of_part[i]);
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
