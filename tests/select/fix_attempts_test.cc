#include "pilotage/select/fix_attempts.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "select/straight_mission.h"
#include <gtest/gtest.h>

namespace pilotage {
namespace {

using testing::straight_mission;

// Tiles of 100 m every 50 m, flown at 20 m/s.
struct FlownPlan {
  Mission mission = straight_mission(2000);
  std::vector<std::optional<std::size_t>> tiles = tiles_under_route(mission);

  std::vector<double> p_of_tile(double p) const { return std::vector<double>(mission.ground.tiles.size(), p); }
};

TEST(FixAttempts, OneIndependentAttemptForEachTileWidth) {
  const FlownPlan scene;
  const auto attempts = fix_attempts(scene.mission, scene.tiles, 2, std::nullopt);
  EXPECT_NEAR(static_cast<double>(attempts.size()), 2000 / 50.0, 1) << "a tile is flown over for one stride";
  EXPECT_NEAR(static_cast<double>(counted_attempts(attempts, scene.p_of_tile(0.5)).size()), 2000 / 100.0, 1);
}

TEST(FixAttempts, TheStatedDistanceAndTheFixIntervalSpaceThem) {
  const FlownPlan scene;
  const auto count = [&](double interval_s, double decorrelation_m) {
    const auto attempts = fix_attempts(scene.mission, scene.tiles, interval_s, decorrelation_m);
    return static_cast<double>(counted_attempts(attempts, scene.p_of_tile(0.5)).size());
  };
  EXPECT_NEAR(count(2, 400), 5, 1);
  EXPECT_NEAR(count(20, 100), 5, 1) << "20 s at 20 m/s";
  EXPECT_NEAR(count(1, 25), 80, 2) << "two for each tile of 50 m";
}

TEST(FixAttempts, OfAWindowTheBestCounts) {
  const FlownPlan scene;
  const auto attempts = fix_attempts(scene.mission, scene.tiles, 2, 300);
  std::vector<double> p = scene.p_of_tile(0.2);
  p[*scene.tiles[100]] = 0.9;
  std::vector<std::size_t> samples;
  for (const std::size_t k : counted_attempts(attempts, p)) samples.push_back(attempts[k].sample);
  const auto best = std::find(samples.begin(), samples.end(), 100U);
  ASSERT_NE(best, samples.end());
  EXPECT_LE(*(best - 1), 90U) << "the window begins at 900 m";
  EXPECT_GE(*(best + 1), 120U) << "and ends at 1,200 m";
  const RouteChances chances = route_chances(attempts, p, scene.tiles.size(), {2, {}, 0});
  EXPECT_EQ(chances.p[100], 0.9);
  EXPECT_EQ(std::count(chances.p.begin(), chances.p.end(), 0.2), static_cast<std::ptrdiff_t>(attempts.size()) - 1);
  EXPECT_EQ(chances.window[100], 3);
  EXPECT_EQ(chances.fix_interval_s, 2);
}

// A tile more never takes a chance away, or the search for the best tiles could not be trusted.
TEST(FixAttempts, ATileMoreNeverTakesAChanceAway) {
  const FlownPlan scene;
  const auto attempts = fix_attempts(scene.mission, scene.tiles, 2, std::nullopt);
  const auto p_none = [&](const std::vector<double>& p) {
    double none = 1;
    for (const std::size_t k : counted_attempts(attempts, p)) none *= 1 - p[attempts[k].tile];
    return none;
  };
  std::vector<double> p = scene.p_of_tile(0);
  double before = 1;
  for (std::size_t k = 0; k < p.size(); ++k) {
    const std::size_t i = k * 17 % p.size();
    p[i] = 0.1 + 0.01 * static_cast<double>(k % 7);
    EXPECT_LE(p_none(p), before);
    before = p_none(p);
  }
  EXPECT_LT(before, 0.2);
}

TEST(ExpectedFixes, EveryTryCounts) {
  const FlownPlan scene;
  const std::vector<bool> stored(scene.mission.ground.tiles.size(), true);
  const ExpectedFixes fixes = expected_fixes(scene.mission, scene.tiles, stored, scene.p_of_tile(0.75), {2, {}, 0.001});
  EXPECT_NEAR(fixes.correct, 51 * 0.75, 1e-9) << "100 s, one try every 2 s, the first at once";
  EXPECT_NEAR(fixes.wrong, 51 * 0.25 * 0.001, 1e-12);
  const std::vector<bool> none(scene.mission.ground.tiles.size(), false);
  EXPECT_EQ(expected_fixes(scene.mission, scene.tiles, none, scene.p_of_tile(0.75), {2, {}, 0.001}).correct, 0);
}

}  // namespace
}  // namespace pilotage
