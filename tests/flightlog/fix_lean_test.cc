#include "pilotage/flightlog/fix_lean.h"

#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/angle.h"
#include "pilotage/base/random.h"

namespace pilotage {
namespace {

using ::testing::AllOf;
using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kTold_m = 120;

MatchOptions told() {
  MatchOptions options;
  options.height_sigma_fraction = 0.03;
  options.attitude_sigma_deg = 0.5;  // 1 m at the told height
  return options;
}

FrameMatch fix_at(double scale, double east_m, double north_m) {
  FrameMatch match;
  match.frame.height_agl_m = kTold_m;
  match.frame.true_nadir = {0, 0};
  match.result.status = MatchStatus::kFix;
  Fix& fix = match.result.fix.emplace();
  fix.scale = scale;
  fix.height_agl_m = scale * kTold_m;
  fix.map_sigma_m = 1;
  match.error = FixError{east_m, north_m, std::hypot(east_m, north_m), 2};
  return match;
}

/// Fixes that scatter by 1 % of the height and 1 m of the place about these.
std::vector<FrameMatch> fixes_about(double scale, double east_m, double north_m, int count = 40) {
  Random random(7);
  std::vector<FrameMatch> matches;
  for (int i = 0; i < count; ++i) {
    matches.push_back(fix_at(scale + 0.01 * random.normal(), east_m + random.normal(), north_m + random.normal()));
  }
  return matches;
}

TEST(FixLean, OfGoodFixesSaysNothing) {
  const FixLean lean = lean_of_fixes(fixes_about(1, 0, 0), told());
  EXPECT_EQ(lean.heights, 40);
  EXPECT_EQ(lean.judged, 40);
  EXPECT_NEAR(lean.height_share.median, 0, 0.005);
  EXPECT_LT(lean.east_m.low, 0);
  EXPECT_GT(lean.east_m.high, 0);
  EXPECT_NEAR(lean.common_sigma_m, std::hypot(1, 120 * std::tan(0.5 * kRadPerDeg)), 0.02);
  EXPECT_THAT(lean_warnings(lean, told()), IsEmpty());
}

TEST(FixLean, OfHeightsOfAnotherDatumNamesShareAndMetres) {
  const FixLean lean = lean_of_fixes(fixes_about(1.08, 0, 0), told());
  EXPECT_THAT(lean.height_m.median, DoubleNear(9.6, 0.5));
  EXPECT_THAT(lean_warnings(lean, told()), ElementsAre(AllOf(HasSubstr(" above the heights"),
                                                             HasSubstr("another datum"), HasSubstr("good to 3.0 %"))));
  EXPECT_THAT(lean_warnings(lean_of_fixes(fixes_about(0.92, 0, 0), told()), told()),
              ElementsAre(HasSubstr(" below the heights")));
  // Told to be no better than that, they lean within what was told.
  MatchOptions coarse = told();
  coarse.height_sigma_fraction = 0.05;
  EXPECT_THAT(lean_warnings(lean, coarse), IsEmpty());
}

TEST(FixLean, OfAShiftedMapNamesLengthAndWay) {
  const FixLean lean = lean_of_fixes(fixes_about(1, 4.5, -4.5), told());
  EXPECT_THAT(
      lean_warnings(lean, told()),
      ElementsAre(AllOf(HasSubstr("to the south-east"), HasSubstr("by which map and attitude may shift them all"))));
  EXPECT_THAT(lean_warnings(lean_of_fixes(fixes_about(1, 0, 8), told()), told()),
              ElementsAre(HasSubstr("to the north,")));
  EXPECT_THAT(lean_warnings(lean_of_fixes(fixes_about(1, -8, 1), told()), told()),
              ElementsAre(HasSubstr("to the west,")));
  // A map that says that it may be off by so much explains it; that one fix lies on such a tile does not.
  std::vector<FrameMatch> coarse = fixes_about(1, 4.5, -4.5);
  coarse.front().result.fix->map_sigma_m = 5;
  EXPECT_EQ(lean_warnings(lean_of_fixes(coarse, told()), told()).size(), 1U);
  for (FrameMatch& match : coarse) match.result.fix->map_sigma_m = 5;
  EXPECT_THAT(lean_warnings(lean_of_fixes(coarse, told()), told()), IsEmpty());
  // A mount that is off by what was told of the attitude shifts the aircraft's place, and not the centre's.
  MatchOptions loose = told();
  loose.attitude_sigma_deg = 2;
  std::vector<FrameMatch> shifted = fixes_about(1, 4.5, -4.5);
  EXPECT_THAT(lean_warnings(lean_of_fixes(shifted, loose), loose), IsEmpty());
  for (FrameMatch& match : shifted) {
    match.frame.true_center = match.frame.true_nadir;
    match.frame.true_nadir.reset();
  }
  EXPECT_EQ(lean_warnings(lean_of_fixes(shifted, loose), loose).size(), 1U);
}

TEST(FixLean, AFalseFixOrFewFixesChangeNothing) {
  std::vector<FrameMatch> matches = fixes_about(1, 0, 0);
  for (int i = 0; i < 4; ++i) matches.push_back(fix_at(1.4, 900, 900));
  EXPECT_THAT(lean_warnings(lean_of_fixes(matches, told()), told()), IsEmpty());
  EXPECT_THAT(lean_warnings(lean_of_fixes(fixes_about(1.08, 20, 20, 10), told()), told()), IsEmpty());
  EXPECT_EQ(lean_text(lean_of_fixes({}, told())), "");
  EXPECT_TRUE(to_json(lean_of_fixes(fixes_about(1.08, 20, 20, 10), told()))["east_m"]["low"].is_null());
}

TEST(Lean, TheIntervalHoldsTheMedianAsOftenAsItSays) {
  // Of 11 values all are on one side of the median in 2 of 2048 draws, of 10 in 2 of 1024.
  EXPECT_TRUE(std::isinf(lean_of(std::vector<double>(10, 1)).low));
  EXPECT_EQ(lean_of({5, 2, 9, 4, 7, 1, 3, 8, 6, 11, 10}).low, 1);
  EXPECT_EQ(lean_of({5, 2, 9, 4, 7, 1, 3, 8, 6, 11, 10}).high, 11);
  Random random(3);
  int outside = 0;
  for (int i = 0; i < 20000; ++i) {
    std::vector<double> values(30);
    for (double& value : values) value = random.normal();
    const Lean lean = lean_of(values);
    if (lean.low > 0 || lean.high < 0) ++outside;
  }
  EXPECT_LE(outside, 33);  // 20 and three standard deviations
  EXPECT_GE(outside, 3);   // the fourth value of 30 is rare enough, the fifth is not
}

TEST(FixLean, CountsFixesAloneAndJudgesThoseOfKnownTruth) {
  std::vector<FrameMatch> matches = fixes_about(1, 0, 0, 6);
  matches[0].result.fix.reset();
  matches[1].problem = "a.jpg: cannot be opened as a raster";
  matches[2].error.reset();
  const FixLean lean = lean_of_fixes(matches, told());
  EXPECT_EQ(lean.heights, 4);
  EXPECT_EQ(lean.judged, 3);
  EXPECT_EQ(to_json(lean)["judged"], 3);
  EXPECT_TRUE(to_json(lean_of_fixes({}, told())).is_null());
}

TEST(FixLean, HeightsAreThoseOfPlacesRefusedByThemToo) {
  std::vector<FrameMatch> matches = fixes_about(1.2, 0, 0, 16);
  for (FrameMatch& match : matches) {
    match.result.status = MatchStatus::kOutsideGate;
    match.result.candidate = match.result.fix;
    match.result.fix.reset();
  }
  const FixLean lean = lean_of_fixes(matches, told());
  EXPECT_EQ(lean.heights, 16);
  EXPECT_EQ(lean.judged, 0);
  EXPECT_THAT(lean_warnings(lean, told()), ElementsAre(HasSubstr(" above the heights")));
  EXPECT_FALSE(to_json(lean).contains("east_m"));
  // A place that is refused for something else, such as the track, says nothing of heights.
  for (FrameMatch& match : matches) match.result.candidate->scale = 1.05;
  EXPECT_EQ(lean_of_fixes(matches, told()).heights, 0);
  // Refused for another reason it may be any place.
  for (FrameMatch& match : matches) match.result.status = MatchStatus::kAmbiguous;
  EXPECT_EQ(lean_of_fixes(matches, told()).heights, 0);
}

TEST(FixLean, ItsLineForPeople) {
  EXPECT_THAT(lean_text(lean_of_fixes(fixes_about(0.92, 0, 6), told())),
              AllOf(HasSubstr("heights "), HasSubstr(" below what was told, places "),
                    HasSubstr(" m to the north (medians)\n")));
}

}  // namespace
}  // namespace pilotage
