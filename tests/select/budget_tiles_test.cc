#include "pilotage/select/budget_tiles.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "select/straight_mission.h"
#include <gtest/gtest.h>

#include "pilotage/base/random.h"
#include "pilotage/select/select_tiles.h"
#include "pilotage/select/storage_count.h"

namespace pilotage {
namespace {

using testing::error_after_s;
using testing::good_scores;
using testing::kStoredSize;
using testing::straight_mission;

// The stretch [from_m, to_m) is flown higher: tiles of 400 m every 200 m, in pixels of the same size, so that a tile
// takes 16 times the bytes.
Mission with_large_tiles(Mission mission, double from_m, double to_m) {
  GridLevel level = mission.ground.levels[0];
  level.matrix.level = 1;
  level.matrix.tile_size_px = 400;
  level.matrix.stride_px = 200;
  level.matrix.map_from_pixel = GeoTransform::north_up(-500, 600, 1);
  level.matrix.grid_height_px = 1200;
  mission.ground.levels.push_back(level);
  for (FlightSample& sample : mission.flight.samples) {
    if (sample.distance_m >= from_m && sample.distance_m < to_m) sample.level = 1;
  }
  const auto replaced = [&](const RoutePlace& place) { return place.distance_m >= from_m && place.distance_m < to_m; };
  std::size_t index = 0;
  std::erase_if(mission.ground.tiles, [&](const GroundTile&) { return replaced(mission.flight.places[index++]); });
  std::erase_if(mission.flight.places, replaced);
  for (std::int64_t column = 0; column < level.matrix.matrix_width(); ++column) {
    GroundTile tile;
    tile.level = 1;
    tile.column = column;
    tile.row = 2;
    tile.tile_id = tile_id_of(mission.ground.levels, 1, column, tile.row);
    tile.bounds = {-500.0 + 200.0 * static_cast<double>(column), -200, -100.0 + 200.0 * static_cast<double>(column),
                   200};
    tile.valid_fraction = 1;
    const RoutePlace place{tile.bounds.center_m().x(), 0};
    if (!replaced(place)) continue;
    mission.ground.tiles.push_back(tile);
    mission.flight.places.push_back(place);
  }
  return mission;
}

// Scores of which only every `step`-th tile can be matched, with P drawn from [0.5, 1).
std::vector<TileScores> some_scores(const Mission& mission, std::size_t step, Random& random) {
  std::vector<TileScores> scores = good_scores(mission);
  for (std::size_t i = 0; i < scores.size(); ++i) {
    scores[i].p_correct_fix = i % step == 0 ? random.uniform(0.5, 1) : 0.1;
    scores[i].degraded.margin = random.uniform(0.1, 0.9);
  }
  return scores;
}

// P within the limit with the stored tiles, and the bytes of them.
struct StoredChoice {
  double p = 0;
  double bytes = 0;
};
StoredChoice outcome_of(const FlightPath& path, const std::vector<FixAttempt>& attempts,
                        const std::vector<double>& p_of_tile) {
  const Mission& mission = *path.mission;
  StorageCount count(mission, kStoredSize);
  for (std::size_t i = 0; i < p_of_tile.size(); ++i) {
    if (p_of_tile[i] > 0) count.add(mission.ground.tiles[i]);
  }
  const auto levels = level_chances(mission, mission.flight.samples, attempts, level_free(p_of_tile), {2, {}, 0.001});
  return {predict_survival(path, levels, 1).p_within_limit.back(), count.bytes()};
}

TEST(BudgetTiles, IsAsGoodAsTheBestOfAllSubsets) {
  Random random(seed_from_name("IsAsGoodAsTheBestOfAllSubsets"));
  double lost = 0;
  int rounds = 0;
  for (; rounds < 6; ++rounds) {
    const Mission mission = with_large_tiles(straight_mission(1800, 0), 600, 1200 + 100 * (rounds % 2));
    const std::vector<TileScores> scores = some_scores(mission, 3, random);
    const double limit_m = error_after_s(mission, 46 + 2 * rounds);
    const FlightPath path = make_flight_path(mission, limit_m);
    const auto attempts = fix_attempts(mission, tiles_under_route(mission), 2, std::nullopt);
    std::vector<std::size_t> candidates;
    for (std::size_t i = 0; i < scores.size(); ++i) {
      if (scores[i].p_correct_fix >= 0.5) candidates.push_back(i);
    }
    ASSERT_GE(candidates.size(), 8U);
    ASSERT_LE(candidates.size(), 11U);
    const double budget = kStoredSize.bytes_fixed + 100000 + 15000 * rounds;
    double best = 0;
    for (unsigned subset = 0; subset < 1U << candidates.size(); ++subset) {
      std::vector<double> p_of_tile(mission.ground.tiles.size(), 0.0);
      StorageCount count(mission, kStoredSize);
      for (std::size_t k = 0; k < candidates.size(); ++k) {
        if ((subset >> k & 1U) == 0) continue;
        p_of_tile[candidates[k]] = scores[candidates[k]].p_correct_fix;
        count.add(mission.ground.tiles[candidates[k]]);
      }
      if (count.bytes() > budget || count.bytes() < 0.5 * (budget + kStoredSize.bytes_fixed)) continue;
      best = std::max(best, outcome_of(path, attempts, p_of_tile).p);
    }
    SelectOptions options;
    options.budget = std::to_string(static_cast<long>(budget));
    Mission limited = mission;
    limited.flight.max_error_m = limit_m;
    const Selection selection = select_tiles(limited, scores, kStoredSize, options);
    ASSERT_TRUE(selection.probability);
    EXPECT_LE(selection.estimated_bytes, budget);
    EXPECT_GT(best, 0.05) << "the case says nothing";
    EXPECT_GE(selection.probability->p_within_limit, 0.9 * best) << "round " << rounds;
    RecordProperty("round_" + std::to_string(rounds),
                   std::to_string(selection.probability->p_within_limit) + " of " + std::to_string(best));
    lost += best - selection.probability->p_within_limit;
  }
  EXPECT_LE(lost / rounds, 0.02) << "mean over the cases";
}

TEST(BudgetTilesThorough, BeatsTheOrderWhereGroundIsExpensive) {
  Random random(seed_from_name("BeatsTheOrderWhereGroundIsExpensive"));
  int better = 0;
  for (int round = 0; round < 4; ++round) {
    Mission mission = with_large_tiles(straight_mission(4000, 50), 1400, 2600);
    mission.flight.max_error_m = error_after_s(mission, 40);
    const std::vector<TileScores> scores = some_scores(mission, 2, random);
    SelectOptions options;
    options.budget = std::to_string(250000 + 60000 * round);
    const Selection found = select_tiles(mission, scores, kStoredSize, options);
    // Without any P the order decides; its tiles are then judged with P.
    std::vector<TileScores> without_p = scores;
    for (TileScores& score : without_p) {
      if (score.p_correct_fix < 0.5) score.status = TileStatus::kFlat;
      score.p_correct_fix = std::nan("");
    }
    const Selection ordered = select_tiles(mission, without_p, kStoredSize, options);
    EXPECT_FALSE(ordered.probability);
    std::vector<double> p_of_tile(mission.ground.tiles.size(), 0.0);
    for (std::size_t i = 0; i < mission.ground.tiles.size(); ++i) {
      const bool stored =
          std::binary_search(ordered.tile_ids.begin(), ordered.tile_ids.end(), mission.ground.tiles[i].tile_id);
      if (stored) p_of_tile[i] = scores[i].p_correct_fix;
    }
    const FlightPath path = make_flight_path(mission, mission.flight.max_error_m);
    const auto attempts = fix_attempts(mission, tiles_under_route(mission), 2, std::nullopt);
    const double p_ordered = outcome_of(path, attempts, p_of_tile).p;
    EXPECT_GE(found.probability->p_within_limit, p_ordered) << "never worse";
    EXPECT_LE(found.estimated_bytes, std::stoll(*options.budget));
    if (found.probability->p_within_limit > p_ordered + 0.05) ++better;
  }
  EXPECT_GE(better, 2);
}

TEST(StorageCount, TakesAwayWhatItAdded) {
  const Mission mission = straight_mission(1000);
  StorageCount count(mission, kStoredSize);
  count.add(mission.ground.tiles[3]);
  const double before = count.bytes();
  EXPECT_LT(count.bytes_of(mission.ground.tiles[4]), count.bytes_of(mission.ground.tiles[9])) << "4 overlaps 3";
  count.add(mission.ground.tiles[4]);
  count.add(mission.ground.tiles[9]);
  count.remove(mission.ground.tiles[4]);
  count.remove(mission.ground.tiles[9]);
  EXPECT_DOUBLE_EQ(count.bytes(), before);
}

}  // namespace
}  // namespace pilotage
