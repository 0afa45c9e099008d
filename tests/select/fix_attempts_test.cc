#include "pilotage/select/fix_attempts.h"

#include <cmath>
#include <numeric>

#include "select/straight_plan.h"
#include <gtest/gtest.h>

namespace pilotage {
namespace {

using testing::straight_plan;

// Tiles of 100 m every 50 m, flown at 20 m/s.
struct Scene {
  TilePlan plan = straight_plan(2000);
  std::vector<std::optional<std::size_t>> tiles = tiles_under_route(plan, TileLookup(plan));

  std::vector<double> p_of_tile(double p) const { return std::vector<double>(plan.tiles.size(), p); }
};

std::size_t count_above_0(const std::vector<double>& p_fix) {
  return static_cast<std::size_t>(std::count_if(p_fix.begin(), p_fix.end(), [](double p) { return p > 0; }));
}

TEST(FixAttempts, OneIndependentAttemptForEachTileWidth) {
  const Scene scene;
  const auto attempts = fix_attempts(scene.plan, scene.tiles, 2, std::nullopt);
  EXPECT_NEAR(static_cast<double>(attempts.size()), 2000 / 50.0, 1) << "a tile is flown over for one stride";
  const auto p_fix = fix_probabilities(attempts, scene.p_of_tile(0.5), scene.tiles.size());
  EXPECT_NEAR(static_cast<double>(count_above_0(p_fix)), 2000 / 100.0, 1);
}

TEST(FixAttempts, TheStatedDistanceAndTheFixIntervalSpaceThem) {
  const Scene scene;
  const auto count = [&](double interval_s, double decorrelation_m) {
    const auto attempts = fix_attempts(scene.plan, scene.tiles, interval_s, decorrelation_m);
    return static_cast<double>(count_above_0(fix_probabilities(attempts, scene.p_of_tile(0.5), scene.tiles.size())));
  };
  EXPECT_NEAR(count(2, 400), 5, 1);
  EXPECT_NEAR(count(20, 100), 5, 1) << "20 s at 20 m/s";
  EXPECT_NEAR(count(1, 25), 80, 2) << "two for each tile of 50 m";
}

TEST(FixAttempts, OfAWindowTheBestCounts) {
  const Scene scene;
  const auto attempts = fix_attempts(scene.plan, scene.tiles, 2, 300);
  std::vector<double> p = scene.p_of_tile(0.2);
  p[*scene.tiles[100]] = 0.9;
  const auto p_fix = fix_probabilities(attempts, p, scene.tiles.size());
  EXPECT_EQ(std::count(p_fix.begin(), p_fix.end(), 0.9), 1);
  EXPECT_EQ(p_fix[100], 0.9);
  for (std::size_t i = 90; i < 120; ++i) EXPECT_EQ(p_fix[i], i == 100 ? 0.9 : 0) << i;
}

// A tile more never takes a chance away, or the search for the best tiles could not be trusted.
TEST(FixAttempts, ATileMoreNeverTakesAChanceAway) {
  const Scene scene;
  const auto attempts = fix_attempts(scene.plan, scene.tiles, 2, std::nullopt);
  const auto p_none = [&](const std::vector<double>& p) {
    double none = 1;
    for (const double one : fix_probabilities(attempts, p, scene.tiles.size())) none *= 1 - one;
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
  const Scene scene;
  const std::vector<bool> stored(scene.plan.tiles.size(), true);
  const ExpectedFixes fixes = expected_fixes(scene.plan, scene.tiles, stored, scene.p_of_tile(0.75), 2, 0.001);
  EXPECT_NEAR(fixes.correct, 51 * 0.75, 1e-9) << "100 s, one try every 2 s, the first at once";
  EXPECT_NEAR(fixes.wrong, 51 * 0.25 * 0.001, 1e-12);
  const std::vector<bool> none(scene.plan.tiles.size(), false);
  EXPECT_EQ(expected_fixes(scene.plan, scene.tiles, none, scene.p_of_tile(0.75), 2, 0.001).correct, 0);
}

}  // namespace
}  // namespace pilotage
