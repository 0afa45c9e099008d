#include "pilotage/score/score_plan.h"

#include <span>
#include <string>

#include "pilotage/matchability/reasons.h"
#include "pilotage/mission/plan_imagery.h"
#include "pilotage/score/add_ground_cover.h"

namespace pilotage {

ScoredPlan score_plan(const TilePlan& plan, const ScoreOptions& options, std::uint64_t seed, int threads,
                      const Progress& progress) {
  ScoredPlan result;
  std::vector<TileScore>& scores = result.scores;
  std::vector<std::size_t> begin_of_level;
  scores.reserve(plan.tiles.size());
  for (const PlanLevel& level : plan.levels) {
    std::vector<const PlanTile*> tiles;
    std::vector<std::int64_t> indices;
    for (const PlanTile& tile : plan.tiles) {
      if (tile.level != level.matrix.level) continue;
      tiles.push_back(&tile);
      indices.push_back(tile.row * level.matrix.matrix_width() + tile.column);
    }
    begin_of_level.push_back(scores.size());
    if (tiles.empty()) continue;
    std::vector<TileScore> of_level = score_tiles(open_plan_imagery(plan, level), level.matrix, level.search_radius_px,
                                                  indices, options, seed, threads, progress);
    if (options.measure(ScoreMeasure::kGroundCover)) {
      add_ground_cover(open_plan_colors(plan, level), level.matrix, of_level, threads, progress);
      add_relief(plan, tiles, of_level);
    }
    for (std::size_t i = 0; i < of_level.size(); ++i) {
      of_level[i].tile_id = tiles[i]->tile_id;
      of_level[i].level = tiles[i]->level;
      of_level[i].column = tiles[i]->column;
      of_level[i].row = tiles[i]->row;
      scores.push_back(of_level[i]);
    }
  }
  if (!options.second_epoch.empty()) {
    result.second_epoch = compare_epochs_of_plan(plan, options, threads, progress);
    for (std::size_t i = 0; i < scores.size(); ++i) scores[i].epoch = result.second_epoch->scores[i];
  }
  begin_of_level.push_back(scores.size());
  for (std::size_t i = 0; i < plan.levels.size(); ++i) {
    const std::size_t count = begin_of_level[i + 1] - begin_of_level[i];
    explain_tiles(reason_context(plan.levels[i]), std::span(scores).subspan(begin_of_level[i], count));
  }
  return result;
}

}  // namespace pilotage
