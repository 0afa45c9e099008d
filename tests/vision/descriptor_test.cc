#include "pilotage/vision/descriptor.h"

#include <set>

#include "testing/features_of_image.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"
#include "pilotage/vision/feature_options.h"
#include "pilotage/vision/features.h"
#include "pilotage/vision/hamming.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(BinaryDescriptor, IsFoundByPatternAndLength) {
  std::set<std::string> names;
  for (const BinaryDescriptor& descriptor : kBinaryDescriptors) {
    EXPECT_EQ(&descriptor_of(descriptor.pattern, descriptor.bits), &descriptor);
    EXPECT_TRUE(is_descriptor_length(descriptor.bits));
    EXPECT_TRUE(names.insert(descriptor_name(descriptor)).second);
    EXPECT_THAT(std::string(kDescriptorBitsHelp), HasSubstr(std::to_string(descriptor.bits)));
  }
  EXPECT_TRUE(names.contains("ground_128"));
  EXPECT_NE(find_descriptor(kDefaultDescriptorPattern, kDefaultDescriptorBits), nullptr);
  EXPECT_EQ(find_descriptor(DescriptorPattern::kOrb, 128), nullptr);
  EXPECT_THAT(
      [] { descriptor_of(DescriptorPattern::kBrief, 256); },
      ThrowsMessage<UsageError>(HasSubstr("descriptor_bits = 256 of the pattern brief is not one of: 128, 512")));
  EXPECT_EQ(descriptor_byte_lengths(), "8, 16, 32, 64");
  EXPECT_FALSE(is_descriptor_length(200));
}

// The matcher's tolerances as whole bits, by hand.
TEST(BinaryDescriptor, TolerancesAreSharesOfItsBits) {
  EXPECT_EQ(descriptor_of(DescriptorPattern::kBrief, 128).support_bits(), 37);
  EXPECT_EQ(descriptor_of(DescriptorPattern::kOrb, 256).support_bits(), 75);
  EXPECT_EQ(descriptor_of(DescriptorPattern::kBrief, 512).support_bits(), 150);
  for (const BinaryDescriptor& descriptor : kBinaryDescriptors) {
    EXPECT_LE(descriptor.support_distance, descriptor.fit_distance);
    EXPECT_LE(descriptor.fit_distance, descriptor.vote_distance);
    EXPECT_LT(descriptor.vote_distance, 0.5) << "half of the bits agree by chance";
  }
}

// Whatever stands in the list can be described, and searched: each feature finds itself.
TEST(BinaryDescriptor, IsDescribedAndSearched) {
  Random random(seed_from_name("IsDescribedAndSearched"));
  cv::Mat gray(160, 160, CV_8U);
  for (int i = 0; i < 160 * 160; ++i) gray.data[i] = static_cast<std::uint8_t>(random.uniform(0, 255));
  for (const BinaryDescriptor& descriptor : kBinaryDescriptors) {
    SCOPED_TRACE(descriptor_name(descriptor));
    FeatureOptions options;
    options.pattern = descriptor.pattern;
    options.descriptor_bits = descriptor.bits;
    ASSERT_NO_THROW(check_feature_options(options));
    const FeatureSet set = testing::features_of_image(gray, options);
    ASSERT_GT(set.size(), 50U);
    EXPECT_EQ(set.descriptor_bytes, descriptor.bytes());
    EXPECT_EQ(&descriptor_of(set), &descriptor);
    const HammingMatches nearest = HammingIndex(set).find_nearest(set, 2);
    for (std::size_t i = 0; i < set.size(); ++i) {
      EXPECT_EQ(nearest.of_query(i)[0].index, i);
      EXPECT_EQ(nearest.of_query(i)[0].distance, 0U);
      EXPECT_GT(nearest.of_query(i)[1].distance, static_cast<std::uint32_t>(descriptor.bits / 8)) << "noise";
    }
  }
}

}  // namespace
}  // namespace pilotage
