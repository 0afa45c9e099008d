#include "pilotage/tile/plan_levels.h"

#include <cmath>

#include <gtest/gtest.h>

#include "pilotage/base/random.h"

namespace pilotage {
namespace {

TEST(AglBands, OneBandUpToAFactorOfTwo) {
  for (const double ratio : {1.0, 1.3, 2.0}) {
    const auto bands = agl_bands({100 * ratio, 100});
    ASSERT_EQ(bands.size(), 1u) << ratio;
    EXPECT_EQ(bands[0].min_agl_m, 100);
    EXPECT_EQ(bands[0].max_agl_m, 100 * ratio);
    EXPECT_NEAR(bands[0].typical_agl_m, 100 * std::sqrt(ratio), 1e-9);
  }
  EXPECT_EQ(agl_bands({100, 201}).size(), 2u);
}

// A steep climb has no sample between its ends: 40 to 190 m are 2.25 octaves, three bands up to 67.2, 113.0 and 190 m.
TEST(AglBands, BandsWithoutAHeightAreLeftOut) {
  const auto bands = agl_bands({40, 190, 41});
  ASSERT_EQ(bands.size(), 2u);
  EXPECT_NEAR(bands[0].max_agl_m, 67.2, 0.05);
  EXPECT_NEAR(bands[1].min_agl_m, 113.0, 0.05);
  EXPECT_EQ(bands[1].max_agl_m, 190);
  EXPECT_EQ(band_of(bands, 40), 0);
  EXPECT_EQ(band_of(bands, 90), 1);
  EXPECT_EQ(agl_bands({100, 800}).size(), 2u);
  EXPECT_EQ(agl_bands({100, 300, 800}).size(), 3u);
}

// Fewest bands, each of at most a factor of 2; every height is served by a band that holds it.
TEST(AglBands, ServeEveryHeight) {
  Random random(seed_from_name("AglBands"));
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<double> heights;
    for (int i = 0; i < 20; ++i) heights.push_back(std::exp(random.uniform(0, 9)));
    const auto bands = agl_bands(heights);
    const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
    EXPECT_EQ(bands.front().min_agl_m, *low);
    EXPECT_EQ(bands.back().max_agl_m, *high);
    EXPECT_LE(bands.size(), static_cast<std::size_t>(std::ceil(std::log2(*high / *low))));
    for (std::size_t i = 0; i < bands.size(); ++i) {
      EXPECT_LE(bands[i].max_agl_m / bands[i].min_agl_m, 2 * (1 + 1e-9));
      if (i > 0) {
        EXPECT_GE(bands[i].min_agl_m, bands[i - 1].max_agl_m * (1 - 1e-9));
      }
    }
    for (const double height : heights) {
      const AglBand& band = bands[static_cast<std::size_t>(band_of(bands, height))];
      EXPECT_GE(height, band.min_agl_m * (1 - 1e-9));
      EXPECT_LE(height, band.max_agl_m * (1 + 1e-9));
    }
  }
}

TEST(AglBands, HeightsOutsideGoToTheNearestBand) {
  const auto bands = agl_bands({100, 390});
  EXPECT_EQ(band_of(bands, 10), 0);
  EXPECT_EQ(band_of(bands, 5000), 1);
}

}  // namespace
}  // namespace pilotage
