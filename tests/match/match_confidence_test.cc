#include "pilotage/match/match_confidence.h"

#include <cmath>

#include <gtest/gtest.h>

namespace pilotage {
namespace {

const BinaryDescriptor kOrb = descriptor_of(DescriptorPattern::kOrb, 256);

double evidence_of(double support, int expected, double ncc = 0, double compared_px = 0) {
  return place_evidence({support, expected, kOrb, 20'000, ncc, compared_px});
}

TEST(LeastEvidence, IsWhereTheRateIsAsAskedFor) {
  for (const double half_width_px : {50.0, 158.0, 600.0}) {
    EXPECT_NEAR(false_fix_rate(least_evidence(0.001, half_width_px), half_width_px), 0.001, 1e-12) << half_width_px;
  }
}

TEST(PlaceEvidence, OfSupportIsTheFittedTail) {
  // 100 features expected: onset 9 + 0.88 · 10 = 17.8, scale 3.08 + 0.098 · 10 = 4.06.
  EXPECT_NEAR(evidence_of(17.8 + 4.06 * 10, 100), 10, 1e-12);
  EXPECT_NEAR(evidence_of(17.8 + 4.06, 100), 1, 1e-12);
  EXPECT_EQ(evidence_of(17.8, 100), 0);
  EXPECT_EQ(evidence_of(3, 100), 0);
}

TEST(PlaceEvidence, EachDescriptorHasItsOwnTail) {
  const auto of_ground = [](int bits) {
    return place_evidence({60, 400, descriptor_of(DescriptorPattern::kGround, bits), 20'000, 0, 0});
  };
  EXPECT_NEAR(of_ground(128), (60 - 1 - 1.4 * 20) / (2.3 + 0.11 * 20), 1e-12);
  EXPECT_NEAR(of_ground(64), (60 + 1 - 2.1 * 20) / (1.8 + 0.12 * 20), 1e-12);
  EXPECT_EQ(of_ground(256), of_ground(128));
}

TEST(PlaceEvidence, ADenserMapHasATailOfItsOwn) {
  const BinaryDescriptor ground = descriptor_of(DescriptorPattern::kGround, 128);
  // Four times the density: 400 features are as many as 100 were, and chance gives 4^0.75 = 2.83 times as much.
  const double factor = std::pow(4.0, 0.75);
  const double onset = factor * (1 + 1.4 * 10);
  const double scale = factor * (2.3 + 0.11 * 10);
  EXPECT_NEAR(place_evidence({onset + 3 * scale, 400, ground, 80'000, 0, 0}), 3, 1e-12);
}

TEST(PlaceEvidence, AThinnerMapHasATailOfItsOwnWhereItWasMeasured) {
  const BinaryDescriptor ground = descriptor_of(DescriptorPattern::kGround, 128);
  const double onset = 1 + 1.4 * std::pow(0.02, 0.1) * 5;
  const double scale = 2.3 * std::cbrt(0.02) + 0.11 * 5;
  EXPECT_NEAR(place_evidence({onset + 3 * scale, 25, ground, 400, 0, 0}), 3, 1e-12);
  EXPECT_EQ(place_evidence({20, 25, ground, 1, 0, 0}), place_evidence({20, 25, ground, 400, 0, 0}))
      << "nothing thinner was measured";
  EXPECT_NEAR(place_evidence({40, 30, ground, 19'999.999, 0, 0}), place_evidence({40, 30, ground, 20'000, 0, 0}), 1e-6);
  // Frames of made-up ground found such support on other ground: 8.7 of 8, 12.1 of 49, 10.1 of 22 features.
  EXPECT_LT(place_evidence({8.7, 8, ground, 400, 0, 0}), 6.9);
  EXPECT_LT(place_evidence({12.1, 49, ground, 400, 0, 0}), 6.9);
  EXPECT_LT(place_evidence({10.1, 22, ground, 400, 0, 0}), 6.9);
  for (const BinaryDescriptor& other : {kOrb, descriptor_of(DescriptorPattern::kGround, 64)}) {
    EXPECT_EQ(place_evidence({40, 30, other, 400, 0, 0}), place_evidence({40, 30, other, 20'000, 0, 0}));
  }
}

TEST(PlaceEvidence, TheMoreFeaturesAreExpectedTheLessASupportSays) {
  double last = evidence_of(60, 0);
  EXPECT_NEAR(last, (60 - 9) / 3.08, 1e-12);
  EXPECT_EQ(evidence_of(60, -5), last) << "fewer than none counts as none";
  for (const int expected : {50, 200, 800}) {
    const double evidence = evidence_of(60, expected);
    EXPECT_LT(evidence, last) << expected;
    last = evidence;
  }
}

TEST(PlaceEvidence, OfCorrelationIsAdded) {
  const double of_support = evidence_of(40, 100);
  ASSERT_GT(of_support, 4);
  // 400 pixels: ncc · 20. The tail begins at 7.9 with scale 0.55.
  EXPECT_NEAR(evidence_of(40, 100, 0.945, 400) - of_support, (0.945 * 20 - 7.9) / 0.55, 1e-12);
  EXPECT_EQ(evidence_of(40, 100, 0.3, 400), of_support) << "between 5 and 7.9 it says nothing";
}

TEST(PlaceEvidence, NoCorrelationSpeaksAgainstAPlace) {
  const double of_support = evidence_of(40, 100);
  EXPECT_NEAR(evidence_of(40, 100, 0.2, 400), of_support - 4, 1e-12);
  EXPECT_NEAR(evidence_of(40, 100, -0.9, 400), of_support - 4, 1e-12);
  EXPECT_EQ(evidence_of(18, 100, 0.2, 400), 0) << "never below 0";
}

/// Of 400 pixels of chips and nothing else.
double evidence_of_chips(double correlation, double agreement, double reach = 29) {
  PlaceEvidence evidence;
  evidence.ncc = correlation / 20;
  evidence.compared_px = 400;
  evidence.agreement = agreement;
  evidence.agreement_reach = reach;
  return chip_evidence(evidence);
}

TEST(ChipEvidence, IsThatOfGrayValuesOrOfDirectionsWhicheverIsMore) {
  const double of_directions = (6 - 3.15) / 0.57;
  EXPECT_NEAR(evidence_of_chips(6, 6), of_directions - std::log(2), 1e-12);
  EXPECT_NEAR(evidence_of_chips(9, 6), of_directions - std::log(2), 1e-12) << "both are of one picture: no sum";
  EXPECT_NEAR(evidence_of_chips(12, 6), (12 - 7.9) / 0.55 - std::log(2), 1e-12);
  EXPECT_NEAR(evidence_of_chips(12, 2), (12 - 7.9) / 0.55 - std::log(2), 1e-12) << "asked all the same";
  EXPECT_NEAR(evidence_of_chips(12, 0, 0), (12 - 7.9) / 0.55, 1e-12) << "not asked";
  EXPECT_EQ(evidence_of_chips(6, 3.2), 0) << "never below what nothing says";
}

TEST(ChipEvidence, SpeaksAgainstAPlaceWhereBothDo) {
  EXPECT_EQ(evidence_of_chips(4, 3), -4);
  EXPECT_EQ(evidence_of_chips(4, 3.2), 0) << "directions that agree say that it need not be";
  EXPECT_GT(evidence_of_chips(4, 5), 2);
}

TEST(ChipEvidence, OfAWiderWindowAnAgreementSaysLess) {
  EXPECT_EQ(evidence_of_chips(6, 6, 3), evidence_of_chips(6, 6, 29)) << "narrower ones were not measured";
  EXPECT_NEAR(evidence_of_chips(6, 6, 58), evidence_of_chips(6, 6, 29) - 2 * std::log(2), 1e-12);
  EXPECT_EQ(evidence_of_chips(6, 6, 300), evidence_of_chips(6, 6, 79)) << "beyond, false_fix_rate() counts the places";
}

TEST(PlaceEvidence, ACorrelationWithoutPixelsIsNone) {
  EXPECT_EQ(evidence_of(40, 100, 0.99, 0), evidence_of(40, 100));
}

TEST(LeastLead, GrowsWithWhatTheRivalHas) {
  EXPECT_EQ(least_lead(7, 0), 3);
  EXPECT_EQ(least_lead(12, 4), 7);
  EXPECT_EQ(least_lead(40, 20), 11);
  EXPECT_EQ(least_lead(100, 20), 20) << "a fifth of its own";
  // Best places and rivals of frames of other orchards, which were taken with a lead of 3 and a fifth.
  EXPECT_LT(39.9 - 31.5, least_lead(39.9, 31.5));
  EXPECT_LT(21.9 - 11.1, least_lead(21.9, 11.1));
  EXPECT_LT(18.2 - 7.8, least_lead(18.2, 7.8));
  EXPECT_LT(8.9 - 5.9, least_lead(8.9, 5.9));
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
