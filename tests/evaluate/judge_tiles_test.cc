#include "pilotage/evaluate/judge_tiles.h"

#include <algorithm>

#include "evaluate/scored_dates.h"
#include "testing/temporary_folder.h"
#include <gtest/gtest.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

using testing::scored_dates;

struct JudgedMap {
  testing::TemporaryFolder folder;
  std::filesystem::path map = folder / "map.gpkg";
  std::vector<std::size_t> tiles = choose_tiles(scored_dates().judged(), 1, 0, 1);

  JudgedMap() { build_evaluation_map(map, scored_dates().judged(), false, 2, {}); }
};

const JudgedMap& judged_map() {
  static const JudgedMap made;
  return made;
}

/// Truth of testing::ScoredDates::moved.
Eigen::Vector2d moved_back(const Eigen::Vector2d& point) {
  return {point.x() - testing::kMoved_m, point.y()};
}

std::vector<TileOutcome> vote(const std::string& other, const PlaceOnReference& place, int threads = 2,
                              const std::vector<std::size_t>& tiles = judged_map().tiles) {
  EvaluateOptions options;
  options.file = other;
  return judge_by_voting(scored_dates().judged(), tiles, judged_map().map, place, options, 3, 1, threads, {});
}

std::vector<TileOutcome> correlate(const std::string& other, const PlaceOnReference& place, int threads = 2) {
  EvaluateOptions options;
  options.file = other;
  options.matcher = EvaluateMatcher::kNcc;
  return judge_by_ncc(scored_dates().judged(), judged_map().tiles, place, options, 1.5, threads, {});
}

std::int64_t count(const std::vector<TileOutcome>& outcomes, Outcome outcome) {
  return std::count_if(outcomes.begin(), outcomes.end(),
                       [&](const TileOutcome& each) { return each.outcome == outcome; });
}

void expect_same(const std::vector<TileOutcome>& a, const std::vector<TileOutcome>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].tile, b[i].tile);
    EXPECT_EQ(a[i].outcome, b[i].outcome);
    EXPECT_EQ(a[i].status, b[i].status);
    EXPECT_TRUE(a[i].error_m == b[i].error_m || (std::isnan(a[i].error_m) && std::isnan(b[i].error_m)));
  }
}

TEST(JudgeByVoting, FindsTheSameDateAlmostEverywhere) {
  const auto outcomes = vote(scored_dates().reference, same_place);
  EXPECT_EQ(outcomes.size(), 81U);
  // Frames of the tiles at the border may look a little beyond it; their centre is still ground.
  EXPECT_GE(count(outcomes, Outcome::kCorrect), 70);
  EXPECT_EQ(count(outcomes, Outcome::kFalse), 0);
  for (const TileOutcome& outcome : outcomes) {
    EXPECT_EQ(outcome.outcome == Outcome::kCorrect, outcome.status == "fix") << outcome.tile;
  }
}

TEST(JudgeByVoting, ATruthThatIsOffMakesFixesFalseAndItsCorrectionRightAgain) {
  const auto unmoved = vote(scored_dates().other, same_place);
  const auto believed = vote(scored_dates().moved, same_place);
  const auto corrected = vote(scored_dates().moved, moved_back);
  EXPECT_GE(count(unmoved, Outcome::kCorrect), 20);
  EXPECT_LE(count(believed, Outcome::kCorrect), 1);
  EXPECT_GE(count(believed, Outcome::kFalse), 15);
  EXPECT_GE(count(corrected, Outcome::kCorrect), 15);
  EXPECT_LE(count(corrected, Outcome::kFalse), 2);
  for (const TileOutcome& outcome : believed) {
    if (outcome.outcome == Outcome::kFalse && outcome.error_m < 10) {
      EXPECT_NEAR(outcome.error_east_m, -testing::kMoved_m, 3);
    }
  }
}

TEST(JudgeByVoting, OutcomesDependNeitherOnThreadsNorOnTheOtherTiles) {
  const auto all = vote(scored_dates().other, same_place, 1);
  expect_same(all, vote(scored_dates().other, same_place, 3));
  const std::vector<std::size_t> some{3, 20, 41};
  expect_same({all[3], all[20], all[41]}, vote(scored_dates().other, same_place, 2, some));
}

TEST(JudgeByNcc, FindsTheSameDateExactly) {
  const auto outcomes = correlate(scored_dates().reference, same_place);
  EXPECT_EQ(count(outcomes, Outcome::kCorrect), 81);
  for (const TileOutcome& outcome : outcomes) {
    EXPECT_EQ(outcome.error_m, 0);
    EXPECT_NEAR(outcome.evidence, 1, 1e-3);
  }
}

TEST(JudgeByNcc, ATruthThatIsOffMakesPlacesFalseAndItsCorrectionRightAgain) {
  const auto believed = correlate(scored_dates().moved, same_place);
  const auto corrected = correlate(scored_dates().moved, moved_back);
  EXPECT_GE(count(corrected, Outcome::kCorrect), 20);
  EXPECT_LE(count(believed, Outcome::kCorrect), 2);
  expect_same(corrected, correlate(scored_dates().moved, moved_back, 1));
}

TEST(JudgeTiles, NeedsRoomToSearch) {
  Ground ground = scored_dates().ground;
  ground.levels[0].search_radius_px = 0;
  const LevelScores judged(ScoreTable(ground, scored_dates().scores), 0);
  EvaluateOptions options;
  options.file = scored_dates().other;
  EXPECT_THROW(judge_by_ncc(judged, judged_map().tiles, same_place, options, 1, 1, {}), UsageError);
  EXPECT_THROW(judge_by_voting(judged, judged_map().tiles, judged_map().map, same_place, options, 1, 1, 1, {}),
               UsageError);
}

}  // namespace
}  // namespace pilotage
