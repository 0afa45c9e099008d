#include "pilotage/score/score_run.h"

#include <numeric>

#include "pilotage/base/error.h"
#include "pilotage/mission/plan_file.h"
#include "pilotage/score/score_plan.h"

namespace pilotage {

ScoreRun open_score_run(const std::vector<std::string>& inputs, const ScoreImageryOptions& options,
                        std::uint64_t seed) {
  ScoreRun run{inputs, options, seed, {}, {}};
  if (inputs.size() == 1 && inputs.front().ends_with(".json")) {
    check_options(options);
    run.plan = read_plan(inputs.front());
  } else {
    run.imagery = open_imagery(inputs, options);
  }
  return run;
}

std::int64_t tile_count(const ScoreRun& run) {
  return run.plan ? static_cast<std::int64_t>(run.plan->ground.tiles.size()) : run.imagery->matrix.tile_count();
}

std::vector<ShardTile> shard_tiles(const ScoreRun& run, const Shard& shard) {
  return run.plan ? shard_tiles(run.plan->ground.tiles, shard) : shard_tiles(run.imagery->matrix, shard);
}

std::optional<SecondEpoch> register_second_epoch(const ScoreRun& run, int threads, const Progress& progress) {
  if (run.options.score.second_epoch.empty()) return std::nullopt;
  return run.plan ? register_second_epoch(*run.plan, run.options.score, threads, progress)
                  : register_second_epoch(*run.imagery, run.options, threads, progress);
}

PartScores score_part(const ScoreRun& run, const std::vector<std::int64_t>& places, int threads,
                      const Progress& progress) {
  PartScores part{{}, register_second_epoch(run, threads, progress)};
  const WarpField* field = part.second_epoch ? &part.second_epoch->registration.fit.field : nullptr;
  part.scores = run.plan ? score_plan_tiles(*run.plan, run.options.score, places, field, run.seed, threads, progress)
                         : score_imagery_tiles(*run.imagery, run.options, places, field, run.seed, threads, progress);
  return part;
}

ScoredRun finish_run(ScoreRun& run, PartScores all, int threads) {
  if (static_cast<std::int64_t>(all.scores.size()) != tile_count(run)) {
    throw DataError(std::to_string(all.scores.size()) + " scores of " + std::to_string(tile_count(run)) + " tiles");
  }
  ScoredRun result;
  result.second_epoch = std::move(all.second_epoch);
  if (result.second_epoch) {
    for (const TileScore& score : all.scores) result.second_epoch->scores.push_back(score.epoch);
  }
  if (run.plan) {
    for (std::size_t i = 0; i < all.scores.size(); ++i) {
      const GroundTile& tile = run.plan->ground.tiles[i];
      all.scores[i].level = tile.level;
      all.scores[i].column = tile.column;
      all.scores[i].row = tile.row;
    }
    explain_plan(*run.plan, all.scores);
    result.crs = run.plan->ground.crs;
    result.rows = tile_rows(run.plan->ground, all.scores);
    return result;
  }
  const TileMatrix& matrix = run.imagery->matrix;
  for (std::size_t i = 0; i < all.scores.size(); ++i) {
    all.scores[i].level = matrix.level;
    all.scores[i].column = static_cast<std::int64_t>(i) % matrix.matrix_width();
    all.scores[i].row = static_cast<std::int64_t>(i) / matrix.matrix_width();
  }
  result.crs = run.imagery->crs;
  result.warnings = run.imagery->warnings;
  run.imagery->source.read = {};
  result.rows = imagery_rows(*run.imagery, std::move(all.scores), threads);
  return result;
}

ScoredRun score_run(ScoreRun& run, int threads, const Progress& progress) {
  std::vector<std::int64_t> places(static_cast<std::size_t>(tile_count(run)));
  std::iota(places.begin(), places.end(), 0);
  return finish_run(run, score_part(run, places, threads, progress), threads);
}

}  // namespace pilotage
