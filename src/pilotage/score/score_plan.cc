#include "pilotage/score/score_plan.h"

#include <numeric>
#include <span>
#include <string>

#include "pilotage/ground/ground_imagery.h"
#include "pilotage/matchability/reasons.h"
#include "pilotage/score/add_ground_cover.h"

namespace pilotage {
namespace {

/// Tiles of one level.
struct LevelTiles {
  const GridLevel* level;
  std::vector<const GroundTile*> tiles;
  std::vector<std::int64_t> indices;

  EpochTiles of_epoch() const { return {level->matrix, level->search_radius_px, indices}; }
};

/// The tiles at `places`, level by level; those of a plan ascend by level, so this is their order.
std::vector<LevelTiles> tiles_of_levels(const Mission& plan, const std::vector<std::int64_t>& places) {
  std::vector<LevelTiles> levels;
  for (const GridLevel& level : plan.ground.levels) {
    LevelTiles of_level{&level, {}, {}};
    for (const std::int64_t place : places) {
      const GroundTile& tile = plan.ground.tiles[static_cast<std::size_t>(place)];
      if (tile.level != level.matrix.level) continue;
      of_level.tiles.push_back(&tile);
      of_level.indices.push_back(tile.row * level.matrix.matrix_width() + tile.column);
    }
    if (!of_level.tiles.empty()) levels.push_back(std::move(of_level));
  }
  return levels;
}

std::vector<std::int64_t> all_places(const Mission& plan) {
  std::vector<std::int64_t> places(plan.ground.tiles.size());
  std::iota(places.begin(), places.end(), 0);
  return places;
}

void score_level(const Mission& plan, const LevelTiles& tiles, const ScoreOptions& options, std::uint64_t seed,
                 int threads, const Progress& progress, std::vector<TileScore>& scores) {
  const GridLevel& level = *tiles.level;
  std::vector<TileScore> of_level = score_tiles(open_gray(plan.ground, level), level.matrix, level.search_radius_px,
                                                tiles.indices, options, seed, threads, progress);
  if (options.measure(ScoreMeasure::kGroundCover)) {
    add_ground_cover(open_colors(plan.ground, level), level.matrix, of_level, threads, progress);
    add_relief(plan, tiles.tiles, of_level);
  }
  for (std::size_t i = 0; i < of_level.size(); ++i) {
    of_level[i].tile_id = tiles.tiles[i]->tile_id;
    of_level[i].level = tiles.tiles[i]->level;
    of_level[i].column = tiles.tiles[i]->column;
    of_level[i].row = tiles.tiles[i]->row;
    scores.push_back(of_level[i]);
  }
}

}  // namespace

SecondEpoch register_second_epoch(const Mission& plan, const ScoreOptions& options, int threads,
                                  const Progress& progress) {
  std::vector<EpochTiles> levels;
  for (const LevelTiles& level : tiles_of_levels(plan, all_places(plan))) levels.push_back(level.of_epoch());
  return register_epochs({dataset_names(plan.ground.imagery), plan.ground.imagery.options, plan.ground.crs}, levels, options,
                         threads, progress);
}

std::vector<TileScore> score_plan_tiles(const Mission& plan, const ScoreOptions& options,
                                        const std::vector<std::int64_t>& places, const WarpField* second_epoch,
                                        std::uint64_t seed, int threads, const Progress& progress) {
  std::vector<TileScore> scores;
  scores.reserve(places.size());
  std::vector<EpochTiles> levels;
  for (const LevelTiles& level : tiles_of_levels(plan, places)) {
    score_level(plan, level, options, seed, threads, progress, scores);
    levels.push_back(level.of_epoch());
  }
  if (second_epoch == nullptr) return scores;
  const std::vector<EpochScores> epochs =
      score_epochs({dataset_names(plan.ground.imagery), plan.ground.imagery.options, plan.ground.crs}, *second_epoch, levels,
                   options, threads, progress);
  for (std::size_t i = 0; i < scores.size(); ++i) scores[i].epoch = epochs[i];
  return scores;
}

void explain_plan(const Mission& plan, std::vector<TileScore>& scores) {
  for (const GridLevel& level : plan.ground.levels) explain_tiles(reason_context(level), scores);
}

ScoredPlan score_plan(const Mission& plan, const ScoreOptions& options, std::uint64_t seed, int threads,
                      const Progress& progress) {
  ScoredPlan result;
  const WarpField* field = nullptr;
  if (!options.second_epoch.empty()) {
    result.second_epoch = register_second_epoch(plan, options, threads, progress);
    field = &result.second_epoch->registration.fit.field;
  }
  result.scores = score_plan_tiles(plan, options, all_places(plan), field, seed, threads, progress);
  for (const TileScore& score : result.scores) {
    if (result.second_epoch) result.second_epoch->scores.push_back(score.epoch);
  }
  explain_plan(plan, result.scores);
  return result;
}

}  // namespace pilotage
