#include "pilotage/mission/integrity.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/json_object.h"
#include "pilotage/base/random.h"

namespace pilotage {
namespace {

TEST(Integrity, IsMisledWhereTheBoundIsWithinTheLimitAndTheErrorIsNot) {
  IntegrityCount count;
  count.look(10, 10, 59, 60);  // bound 37 m
  count.look(10, 10, 61, 60);  // wrong
  count.look(20, 17, 61, 60);  // 63 m: not clear, so nobody is misled
  count.look(60, 17, 5, 60);
  const Integrity found = count.result(60);
  EXPECT_DOUBLE_EQ(found.looked, 100);
  EXPECT_DOUBLE_EQ(found.clear_share, 0.2);
  EXPECT_DOUBLE_EQ(found.misled_share, 0.1);
  EXPECT_EQ(found.stretches, 1) << "one stretch, one error";
  EXPECT_EQ(found.misled.low, 0);
  EXPECT_NEAR(found.misled.high, 1, 1e-9);
}

TEST(Integrity, StretchesOfOneLengthCountOneByOne) {
  IntegrityCount sum;
  for (int flight = 0; flight < 10; ++flight) {
    IntegrityCount count;
    for (int stretch = 0; stretch < 30; ++stretch) {
      for (int look = 0; look < 7; ++look) count.look(0.1, 5, flight == 0 && stretch < 3 ? 100 : 1, 60);
      count.end_stretch();
    }
    sum.add(count);
  }
  const Integrity found = sum.result(60);
  EXPECT_EQ(found.stretches, 300);
  EXPECT_NEAR(found.misled_share, 0.01, 1e-12);
  EXPECT_NEAR(found.misled.low, binomial_interval(3, 300).low, 2e-3);
  EXPECT_NEAR(found.misled.high, binomial_interval(3, 300).high, 2e-3);
  EXPECT_LE(found.misled.low, found.misled_share);
  EXPECT_GE(found.misled.high, found.misled_share);
}

TEST(Integrity, StretchesOfUnequalLengthCountForFewer) {
  IntegrityCount count;
  for (int i = 0; i < 100; ++i) {
    count.look(1, 5, 1, 60);
    count.end_stretch();
  }
  count.look(100, 5, 1, 60);
  EXPECT_EQ(count.result(60).stretches, 3) << "200² / (100 + 100²)";
}

TEST(Integrity, OfNothingSaysNothing) {
  const Integrity nothing = IntegrityCount().result(60);
  EXPECT_TRUE(std::isnan(nothing.misled_share));
  EXPECT_EQ(nothing.misled.low, 0);
  EXPECT_EQ(nothing.misled.high, 1);
  EXPECT_EQ(integrity_text(nothing), "integrity: nothing was looked at without GNSS");
}

// Errors drawn from the covariance that is believed exceed the bound as often as is said: once in a thousand.
TEST(Integrity, AnHonestFilterExceedsItsBoundOnceInAThousand) {
  Random random(7);
  const double bound_m = integrity_sigma_multiple() * 16;
  IntegrityCount count;
  constexpr int kLooks = 200000;
  for (int i = 0; i < kLooks; ++i) {
    count.look(1, 16, 16 * std::hypot(random.normal(), random.normal()), bound_m * (1 + 1e-12));
    count.end_stretch();
  }
  const Integrity found = count.result(bound_m);
  EXPECT_EQ(found.clear_share, 1);
  EXPECT_LE(found.misled.low, kBeyondBound);
  EXPECT_GE(found.misled.high, kBeyondBound);
}

TEST(Integrity, SurvivesItsFile) {
  IntegrityCount count;
  count.look(3, 5, 1, 60);
  count.look(1, 5, 90, 60);
  const Integrity before = count.result(60);
  const nlohmann::ordered_json json = integrity_to_json(before);
  const Integrity after = integrity_from_json(JsonObject(json, "i.json"));
  EXPECT_EQ(integrity_to_json(after), json);
  EXPECT_THAT(integrity_text(after), ::testing::HasSubstr("for 1.000 of the flight, and wrong for 0.25000 [0.00000, "));
}

}  // namespace
}  // namespace pilotage
