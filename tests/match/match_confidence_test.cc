#include "pilotage/match/match_confidence.h"

#include <cmath>

#include <gtest/gtest.h>

namespace pilotage {
namespace {

TEST(PlaceEvidence, OfSupportIsTheFittedTail) {
  // 100 features expected: onset 9 + 0.88 · 10 = 17.8, scale 1.4 · (2.2 + 0.07 · 10) = 4.06.
  EXPECT_NEAR(place_evidence({17.8 + 4.06 * 10, 100, 0, 0}), 10, 1e-12);
  EXPECT_NEAR(place_evidence({17.8 + 4.06, 100, 0, 0}), 1, 1e-12);
  EXPECT_EQ(place_evidence({17.8, 100, 0, 0}), 0);
  EXPECT_EQ(place_evidence({3, 100, 0, 0}), 0);
}

TEST(PlaceEvidence, TheMoreFeaturesAreExpectedTheLessASupportSays) {
  double last = place_evidence({60, 0, 0, 0});
  EXPECT_NEAR(last, (60 - 9) / (1.4 * 2.2), 1e-12);
  EXPECT_EQ(place_evidence({60, -5, 0, 0}), last) << "fewer than none counts as none";
  for (const int expected : {50, 200, 800}) {
    const double evidence = place_evidence({60, expected, 0, 0});
    EXPECT_LT(evidence, last) << expected;
    last = evidence;
  }
}

TEST(PlaceEvidence, OfCorrelationIsAdded) {
  const double of_support = place_evidence({40, 100, 0, 0});
  ASSERT_GT(of_support, 4);
  // 400 pixels: ncc · 20. The tail begins at 7.9 with scale 0.55.
  EXPECT_NEAR(place_evidence({40, 100, 0.945, 400}) - of_support, (0.945 * 20 - 7.9) / 0.55, 1e-12);
  EXPECT_EQ(place_evidence({40, 100, 0.3, 400}), of_support) << "between 5 and 7.9 it says nothing";
}

TEST(PlaceEvidence, NoCorrelationSpeaksAgainstAPlace) {
  const double of_support = place_evidence({40, 100, 0, 0});
  EXPECT_NEAR(place_evidence({40, 100, 0.2, 400}), of_support - 4, 1e-12);
  EXPECT_NEAR(place_evidence({40, 100, -0.9, 400}), of_support - 4, 1e-12);
  EXPECT_EQ(place_evidence({18, 100, 0.2, 400}), 0) << "never below 0";
}

TEST(PlaceEvidence, ACorrelationWithoutPixelsIsNone) {
  EXPECT_EQ(place_evidence({40, 100, 0.99, 0}), place_evidence({40, 100, 0, 0}));
}

TEST(FalseFixRate, IsTheExponential) {
  EXPECT_EQ(false_fix_rate(0, 100), 1);
  EXPECT_NEAR(false_fix_rate(std::log(1000.0), kCalibratedHalfWidthPx), 1e-3, 1e-15);
  EXPECT_LT(false_fix_rate(20, 100), false_fix_rate(19, 100));
}

TEST(FalseFixRate, GrowsWithTheGroundThatIsSearched) {
  const double rate = false_fix_rate(12, kCalibratedHalfWidthPx);
  EXPECT_EQ(false_fix_rate(12, 1), rate) << "a smaller square promises no more than was measured";
  EXPECT_NEAR(false_fix_rate(12, 3 * kCalibratedHalfWidthPx), 9 * rate, 1e-12);
  EXPECT_EQ(false_fix_rate(1, 4096), 1) << "a rate, however large the square";
}

}  // namespace
}  // namespace pilotage
