#include "pilotage/replay/tile_contradictions.h"

#include <gtest/gtest.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

FlownTile flown(std::int64_t id, double p, std::int64_t passes, std::int64_t won) {
  return {id, {16.5, 55.5}, p, passes, won};
}

TEST(BinomialAtMost, IsTheSumOfItsTerms) {
  EXPECT_NEAR(binomial_at_most(0, 3, 0.9), 0.001, 1e-12);
  EXPECT_NEAR(binomial_at_most(1, 3, 0.5), 0.5, 1e-12);
  EXPECT_NEAR(binomial_at_most(2, 10, 0.3), 0.3827827864, 1e-10);
  EXPECT_EQ(binomial_at_most(0, 5, 1), 0);
  EXPECT_EQ(binomial_at_most(0, 5, 0), 1);
}

TEST(Contradictions, OneLostPassOfManyTilesProvesNothing) {
  std::vector<FlownTile> tiles;
  for (std::int64_t i = 0; i < 100; ++i) tiles.push_back(flown(i, 0.96, 1, i % 25 == 0 ? 0 : 1));
  const Contradictions found = find_contradictions(tiles);
  EXPECT_EQ(found.tiles, 100);
  EXPECT_EQ(found.suspects.size(), 4U);
  EXPECT_NEAR(found.expected_below_5_percent, 4, 1e-9);
  for (const Contradiction& suspect : found.suspects) EXPECT_FALSE(suspect.refresh);
}

TEST(Contradictions, TileThatIsLostAgainAndAgainIsOnTheList) {
  std::vector<FlownTile> tiles;
  for (std::int64_t i = 0; i < 100; ++i) tiles.push_back(flown(i, 0.9, 4, i == 42 ? 0 : 4));
  const Contradictions found = find_contradictions(tiles);
  ASSERT_EQ(found.suspects.size(), 1U);
  EXPECT_EQ(found.suspects[0].tile.tile_id, 42);
  EXPECT_NEAR(found.suspects[0].chance, 1e-4, 1e-12);
  EXPECT_TRUE(found.suspects[0].refresh);
}

// Benjamini and Hochberg's step-up: the largest rank whose chance is below its limit takes all before it along.
TEST(Contradictions, StepUpTakesSmallerChancesAlong) {
  std::vector<FlownTile> tiles{flown(1, 0.94, 1, 0), flown(2, 0.93, 1, 0), flown(3, 0.92, 1, 0)};
  const Contradictions found = find_contradictions(tiles);  // 0.06, 0.07, 0.08 against 0.033, 0.067, 0.1
  ASSERT_EQ(found.suspects.size(), 3U);
  for (const Contradiction& suspect : found.suspects) EXPECT_TRUE(suspect.refresh);
}

TEST(Contradictions, ImpossibleCountsAreRefused) {
  const std::vector<FlownTile> tiles{flown(7, 0.9, 1, 2)};
  EXPECT_THROW(find_contradictions(tiles), UsageError);
}

}  // namespace
}  // namespace pilotage
