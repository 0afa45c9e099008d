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

namespace pilotage {
namespace {

/// Tiles of a ground ascend by level.
struct ByLevel {
  bool operator()(const GroundTile& tile, int level) const { return tile.level < level; }
  bool operator()(int level, const GroundTile& tile) const { return level < tile.level; }
};

/// How many measures go over the tiles one after the other.
int count_passes(const ScoreOptions& options) {
  const bool model = options.measure(ScoreMeasure::kCorrectFix);  // statistics, fine contrast, votes
  const bool of_gray = options.measures_surface() || options.measure(ScoreMeasure::kGrayVariance) ||
                       options.measure(ScoreMeasure::kFriedenEntropy);
  return (model ? 3 : of_gray ? 1 : 0) + (options.measure(ScoreMeasure::kGroundCover) ? 1 : 0);
}

/// The parts of a level (places in `indices`) that all measures go over before the next one is begun: what the first of
/// them has warped, the others find in memory. Whole blocks of tiles, and as large as will stay with what lies around
/// them. One part where all of the level stays, where nothing would, and for one measure.
std::vector<std::vector<std::size_t>> parts_of_level(const TileScoring& scoring, std::int64_t kept_px,
                                                     std::span<const std::int64_t> indices) {
  constexpr int kUnit_px = 512;  // what is kept begins and ends at borders of blocks of about this size
  const TileMatrix& matrix = scoring.matrix;
  const BlockSize block = block_size(scoring);
  const std::int64_t block_width_px = block.columns * matrix.stride_px;
  const std::int64_t block_height_px = block.rows * matrix.stride_px;
  const int reach_px = std::max({scoring.radius_px, scoring.margin_px, kVoteReach_px});
  const std::int64_t around_px = matrix.tile_size_px + 2 * reach_px + 2 * kUnit_px;
  // As wide as high, where blocks are not wider than that.
  const auto side_px = static_cast<std::int64_t>(std::sqrt(static_cast<double>(kept_px))) - around_px;
  const std::int64_t width_px = std::max<std::int64_t>(1, side_px / block_width_px) * block_width_px;
  const std::int64_t room_px = kept_px / (width_px + around_px) - around_px;
  const std::int64_t height_px = room_px / block_height_px * block_height_px;
  const bool all_stays = matrix.grid_width_px * matrix.grid_height_px <= kept_px;
  if (all_stays || height_px <= 0 || count_passes(scoring.options) < 2) {
    std::vector<std::size_t> all(indices.size());
    std::iota(all.begin(), all.end(), 0U);
    return {all};
  }
  return tiles_by_rectangle(matrix, indices, width_px, height_px);
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
      begin_scoring(imagery.gray, level.matrix, level.search_radius_px, options, seed, threads, progress);
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
