#include "pilotage/flightlog/match_evaluation.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"

namespace pilotage {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::Pair;

FrameMatch with_fix(double error_m, double nees, double milliseconds = 10) {
  FrameMatch match;
  match.frame.true_nadir = {0, 0};
  match.result.status = MatchStatus::kFix;
  match.result.fix.emplace();
  match.error = FixError{error_m, 0, error_m, nees};
  match.milliseconds = milliseconds;
  return match;
}

FrameMatch refused(MatchStatus status) {
  FrameMatch match;
  match.frame.true_nadir = {0, 0};
  match.result.status = status;
  match.milliseconds = 30;
  return match;
}

FrameMatch unreadable() {
  FrameMatch match;
  match.frame.true_nadir = {0, 0};
  match.problem = "a.jpg: cannot be opened as a raster";
  return match;
}

TEST(EvaluateMatches, CountsEveryFrameOnce) {
  std::vector<FrameMatch> matches{with_fix(1, 2),
                                  with_fix(5, 4),
                                  with_fix(5.001, 9),
                                  with_fix(80, 9),
                                  refused(MatchStatus::kAmbiguous),
                                  refused(MatchStatus::kNoMap),
                                  refused(MatchStatus::kAmbiguous),
                                  unreadable()};
  for (FrameMatch& match : matches) match.result.map_statuses.resize(3);
  matches[1].result.map_index = 2;
  const MatchEvaluation evaluation = evaluate_matches(matches, 5);
  EXPECT_EQ(evaluation.frames, 8);
  EXPECT_THAT(evaluation.fixes_by_map, ElementsAre(3, 0, 1));
  EXPECT_EQ(evaluation.unreadable, 1);
  EXPECT_EQ(evaluation.accepted, 4);
  EXPECT_THAT(evaluation.refused, ElementsAre(Pair("ambiguous", 2), Pair("no_map", 1), Pair("unreadable", 1)));
  EXPECT_EQ(evaluation.correct.count, 2) << "the limit itself is correct";
  EXPECT_EQ(evaluation.correct.of, 8) << "what cannot be read got no fix either";
  EXPECT_EQ(evaluation.correct.value(), 0.25);
  EXPECT_EQ(evaluation.false_fixes.count, 2);
  EXPECT_EQ(evaluation.false_fixes.of, 4);
  EXPECT_EQ(evaluation.false_fixes.value(), 0.5);
  EXPECT_DOUBLE_EQ(evaluation.median_error_m, (5 + 5.001) / 2);
  EXPECT_EQ(evaluation.median_ms, 10);
}

TEST(EvaluateMatches, FramesWithoutTruthAreNotJudged) {
  std::vector<FrameMatch> matches{with_fix(1, 2), with_fix(100, 2)};
  matches[1].frame.true_nadir.reset();
  matches[1].error.reset();
  const MatchEvaluation evaluation = evaluate_matches(matches, 5);
  EXPECT_EQ(evaluation.accepted, 2);
  EXPECT_EQ(evaluation.frames_with_truth, 1);
  EXPECT_EQ(evaluation.correct.value(), 1);
  EXPECT_EQ(evaluation.false_fixes.of, 1);
}

TEST(EvaluateMatches, JudgesTheAircraftsPlaceAndTellsOfTheCentre) {
  std::vector<FrameMatch> matches{with_fix(6, 9), with_fix(2, 2), with_fix(1, 1)};
  for (FrameMatch& match : matches) {
    match.frame.true_center = {0, 0};
    match.center_error = FixError{0.5, 0, 0.5, 0.3};
  }
  const MatchEvaluation both = evaluate_matches(matches, 5);
  EXPECT_EQ(both.correct.count, 2) << "a centre that is right does not make the place right";
  EXPECT_EQ(both.judged_at_center, 0);
  ASSERT_TRUE(both.centers);
  EXPECT_EQ(both.centers->fixes, 3);
  EXPECT_EQ(both.centers->within, 3);
  EXPECT_EQ(both.centers->median_error_m, 0.5);
  EXPECT_THAT(evaluation_text(both, false), HasSubstr("judged by the aircraft's own place"));
  EXPECT_THAT(evaluation_text(both, false), HasSubstr("at the centre of the image: 3 of 3 fixes within 5 m"));

  for (FrameMatch& match : matches) {
    match.frame.true_nadir.reset();
    match.error = match.center_error;
  }
  const MatchEvaluation centers = evaluate_matches(matches, 5);
  EXPECT_EQ(centers.correct.count, 3);
  EXPECT_EQ(centers.judged_at_center, 3);
  EXPECT_FALSE(centers.centers) << "it has been told already";
  EXPECT_THAT(evaluation_text(centers, false), HasSubstr("the aircraft's own place (true_nadir_lon_deg)"));
}

// 480 fixes have 960 degrees of freedom; the band as in base/statistics_test.cc.
TEST(EvaluateMatches, NeesHasItsBand) {
  std::vector<FrameMatch> matches;
  for (int i = 0; i < 480; ++i) matches.push_back(with_fix(1, i % 2 == 0 ? 1.5 : 2.5));
  MatchEvaluation evaluation = evaluate_matches(matches, 5);
  EXPECT_EQ(evaluation.nees.count, 480);
  EXPECT_DOUBLE_EQ(evaluation.nees.mean, 2);
  EXPECT_NEAR(evaluation.nees.band.low, 876.028394364282 / 480, 1e-9);
  EXPECT_NEAR(evaluation.nees.band.high, 1047.759649476826 / 480, 1e-9);
  EXPECT_TRUE(evaluation.nees.inside());
  // One false fix spoils the mean over all, not that over the correct ones.
  matches.push_back(with_fix(100, 1000));
  evaluation = evaluate_matches(matches, 5);
  EXPECT_FALSE(evaluation.nees.inside());
  EXPECT_TRUE(evaluation.nees_correct.inside());
  EXPECT_EQ(evaluation.nees_correct.count, 480);
}

TEST(EvaluateMatches, NeesThatIsNotDefinedIsLeftOut) {
  const std::vector<FrameMatch> matches{with_fix(1, std::nan("")), with_fix(1, 3)};
  EXPECT_EQ(evaluate_matches(matches, 5).nees.count, 1);
  EXPECT_EQ(evaluate_matches(matches, 5).nees.mean, 3);
}

// Honest covariances are inside the band about 95 times of 100.
TEST(EvaluateMatches, HonestCovariancesAreInsideTheBand) {
  Random random(seed_from_name("HonestCovariances"));
  int inside = 0;
  for (int flight = 0; flight < 400; ++flight) {
    std::vector<FrameMatch> matches;
    for (int i = 0; i < 50; ++i) {
      matches.push_back(with_fix(1, std::pow(random.normal(), 2) + std::pow(random.normal(), 2)));
    }
    inside += evaluate_matches(matches, 5).nees.inside();
  }
  EXPECT_NEAR(inside, 380, 4 * std::sqrt(400 * 0.95 * 0.05));
}

TEST(EvaluateMatches, NothingToJudgeIsSaidAsSuch) {
  const std::vector<FrameMatch> matches{refused(MatchStatus::kNoMap)};
  const auto json = to_json(evaluate_matches(matches, 5));
  EXPECT_EQ(json["correct_fixes"]["rate"], 0);
  EXPECT_TRUE(json["false_fixes"]["rate"].is_null());
  EXPECT_TRUE(json["median_error_m"].is_null());
  EXPECT_TRUE(json["nees"]["mean"].is_null());
  EXPECT_THAT(evaluation_text(evaluate_matches(matches, 5)), HasSubstr("false fixes, beyond 5 m: undefined (0 of 0"));
  std::vector<FrameMatch> without_truth = matches;
  without_truth[0].frame.true_nadir.reset();
  EXPECT_FALSE(to_json(evaluate_matches(without_truth, 5)).contains("correct_fixes"));
  EXPECT_THAT(evaluation_text(evaluate_matches(without_truth, 5)), Not(HasSubstr("correct")));
  EXPECT_EQ(evaluate_matches({}, 5).frames, 0);
}

TEST(EvaluateMatches, TextAndJsonSayBothRatesWithTheirIntervals) {
  const std::vector<FrameMatch> matches{with_fix(1, 2), with_fix(9, 2), refused(MatchStatus::kNoMap)};
  const MatchEvaluation evaluation = evaluate_matches(matches, 5);
  const std::string text = evaluation_text(evaluation);
  EXPECT_THAT(text, HasSubstr("3 frames, 2 fixes\n  1 no_map\n"));
  EXPECT_THAT(text, HasSubstr("correct fixes, within 5 m: 33.33 % (1 of 3 frames; 95 % interval 0.84 to 90.57 %)"));
  EXPECT_THAT(text, HasSubstr("false fixes, beyond 5 m: 50.00 % (1 of 2 fixes; 95 % interval 1.26 to 98.74 %)"));
  EXPECT_THAT(text, HasSubstr("time of matching: median 10.0 ms"));
  EXPECT_THAT(evaluation_text(evaluation, false), Not(HasSubstr("ms")));
  EXPECT_FALSE(to_json(evaluation, false).contains("median_ms"));
  EXPECT_EQ(to_json(evaluation)["refused"]["no_map"], 1);
}

TEST(EvaluateMatches, ALimitMustBeAboveZero) {
  EXPECT_THROW(evaluate_matches({}, 0), UsageError);
  EXPECT_THROW(evaluate_matches({}, std::nan("")), UsageError);
}

}  // namespace
}  // namespace pilotage
