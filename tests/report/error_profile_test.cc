#include "pilotage/report/error_profile.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "pilotage/base/random.h"

namespace pilotage {
namespace {

TEST(ErrorProfile, StretchesOfFixes) {
  const std::vector<ErrorSample> profile = {{0, 1, true}, {10, 1, true}, {20, 2, false}, {30, 3, false}, {40, 1, true}};
  const auto stretches = fix_stretches(profile);
  ASSERT_EQ(stretches.size(), 2U);
  EXPECT_EQ(stretches[0].from_distance_m, 0);
  EXPECT_EQ(stretches[0].to_distance_m, 20);
  EXPECT_EQ(stretches[1].from_distance_m, 40);
  EXPECT_EQ(stretches[1].to_distance_m, 40);
  EXPECT_TRUE(fix_stretches({}).empty());
  EXPECT_TRUE(fix_stretches({{0, 1, false}}).empty());
}

TEST(ErrorProfile, ThinningKeepsExtremesEndsAndOrder) {
  Random random(seed_from_name("ThinningKeepsExtremesEndsAndOrder"));
  std::vector<ErrorSample> profile;
  for (int i = 0; i < 20011; ++i) profile.push_back({10.0 * i, random.uniform(0, 40), i % 3 == 0});
  profile[12345].error_m = 99;
  const auto thinned = thin_profile(profile, 2000);
  EXPECT_LE(thinned.size(), 2000U);
  EXPECT_GE(thinned.size(), 1000U);
  EXPECT_EQ(thinned.front().distance_m, 0);
  EXPECT_EQ(thinned.back().distance_m, profile.back().distance_m);
  const auto by_error = [](const ErrorSample& a, const ErrorSample& b) { return a.error_m < b.error_m; };
  EXPECT_EQ(std::max_element(thinned.begin(), thinned.end(), by_error)->error_m, 99);
  EXPECT_EQ(std::min_element(thinned.begin(), thinned.end(), by_error)->error_m,
            std::min_element(profile.begin(), profile.end(), by_error)->error_m);
  for (std::size_t i = 1; i < thinned.size(); ++i) EXPECT_GT(thinned[i].distance_m, thinned[i - 1].distance_m);
}

TEST(ErrorProfile, UnknownErrorsSurviveThinning) {
  std::vector<ErrorSample> profile;
  for (int i = 0; i < 5000; ++i) profile.push_back({1.0 * i, 5, true});
  profile[777].error_m = std::numeric_limits<double>::quiet_NaN();
  const auto thinned = thin_profile(profile, 100);
  EXPECT_TRUE(std::any_of(thinned.begin(), thinned.end(), [](const ErrorSample& s) { return std::isnan(s.error_m); }));
}

TEST(ErrorProfile, ShortProfilesStayAsTheyAre) {
  const std::vector<ErrorSample> profile = {{0, 1, true}, {10, 2, true}};
  EXPECT_EQ(thin_profile(profile, 8).size(), 2U);
}

}  // namespace
}  // namespace pilotage
