#include "pilotage/registration/surviving_features.h"

#include <numeric>

#include "registration/two_dates.h"
#include "testing/features_of_image.h"
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "pilotage/vision/features.h"

namespace pilotage {
namespace {

double share_of(const FeatureSet& reference, const FeatureSet& second) {
  const auto survives = surviving_features(reference, second);
  return std::accumulate(survives.begin(), survives.end(), 0.0) / static_cast<double>(survives.size());
}

FeatureSet moved(FeatureSet features, float dx_px) {
  for (Feature& feature : features.features) feature.x_px += dx_px;
  return features;
}

TEST(SurvivingFeatures, ThoseWhoseDescriptorStandsNear) {
  const cv::Mat ground = testing::random_texture(400, "surviving");
  const FeatureSet reference = testing::features_of_image(ground, {});
  ASSERT_GT(reference.size(), 500U);
  EXPECT_EQ(share_of(reference, reference), 1);
  EXPECT_EQ(share_of(reference, moved(reference, 1.5F)), 1);
  EXPECT_LT(share_of(reference, moved(reference, 1.6F)), 0.2) << "neighbours may resemble, most do not";
  EXPECT_LT(share_of(reference, testing::features_of_image(testing::random_texture(400, "elsewhere"), {})), 0.02);
}

TEST(SurvivingFeatures, BoundOfBitsIsInclusive) {
  FeatureSet reference;
  reference.features = {{10, 10, 0, 1}};
  reference.descriptors.assign(static_cast<std::size_t>(reference.descriptor_bytes), 0);
  FeatureSet second = reference;
  for (std::size_t i = 0; i < 5; ++i) second.descriptors[i] = 0xFF;
  second.descriptors[5] = 0x07;  // 43 of 128 bits
  EXPECT_EQ(share_of(reference, second), 1);
  second.descriptors[6] = 1;  // 44
  EXPECT_EQ(share_of(reference, second), 0);
  EXPECT_EQ(surviving_features(reference, {}), std::vector<std::uint8_t>{0});
  EXPECT_TRUE(surviving_features({}, second).empty());
}

}  // namespace
}  // namespace pilotage
