#include "pilotage/score/score_run.h"

#include "pilotage/base/error.h"
#include "pilotage/mission/plan_file.h"

namespace pilotage {

ScoreRun open_score_run(const std::vector<std::string>& inputs, const ScoreRunOptions& options, std::uint64_t seed,
                        const Progress& progress) {
  check_options(options);
  if (inputs.size() == 1 && inputs.front().ends_with(".json")) {
    refuse_raster_grid(options.grid, inputs.front());
    Mission mission = read_plan(inputs.front());
    return {inputs, options, seed, std::move(mission.ground), std::move(mission.flight), {}};
  }
  RasterGround rasters = ground_of_rasters(inputs, options.grid, progress);
  return {inputs, options, seed, std::move(rasters.ground), {}, std::move(rasters.warnings)};
}

std::int64_t tile_count(const ScoreRun& run) {
  return run.flight ? static_cast<std::int64_t>(run.ground.tiles.size())
                    : run.ground.levels.front().matrix.tile_count();
}

std::vector<ShardTile> shard_tiles(const ScoreRun& run, const Shard& shard) {
  return run.flight ? shard_tiles(run.ground.tiles, shard) : shard_tiles(run.ground.levels.front().matrix, shard);
}

Ground part_of_ground(const ScoreRun& run, const std::vector<std::int64_t>& places, int threads) {
  Ground part = run.ground;
  if (!run.flight) {
    cut_tiles(part, places, threads);
    return part;
  }
  part.tiles.clear();
  for (const std::int64_t place : places) part.tiles.push_back(run.ground.tiles[static_cast<std::size_t>(place)]);
  return part;
}

Ground whole_ground(const ScoreRun& run, int threads) {
  Ground whole = run.ground;
  if (!run.flight) cut_all_tiles(whole, threads);
  return whole;
}

}  // namespace pilotage
