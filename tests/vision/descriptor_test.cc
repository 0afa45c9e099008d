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

TEST(BinaryDescriptor, IsFoundByItsLength) {
  for (const BinaryDescriptor& descriptor : kBinaryDescriptors) {
    EXPECT_EQ(find_descriptor(descriptor.bits), &descriptor);
    EXPECT_EQ(&descriptor_of_bits(descriptor.bits), &descriptor);
    EXPECT_GE(descriptor.bits, kLeastDescriptorBits);
    EXPECT_LE(descriptor.bits, kMostDescriptorBits);
  }
  EXPECT_NE(find_descriptor(kDefaultDescriptorBits), nullptr);
  EXPECT_EQ(find_descriptor(200), nullptr);
  EXPECT_THAT([] { descriptor_of_bits(200); },
              ThrowsMessage<UsageError>(HasSubstr("descriptor_bits = 200 is not one of: 128, 256, 512")));
  EXPECT_EQ(descriptor_lengths(8), "16, 32, 64");
}

TEST(BinaryDescriptor, SaysWhatItIsInOneWordAndInOptions) {
  std::set<std::string_view> names;
  for (const BinaryDescriptor& descriptor : kBinaryDescriptors) {
    EXPECT_TRUE(names.insert(descriptor.name).second) << descriptor.name;
    EXPECT_THAT(std::string(kDescriptorBitsHelp), HasSubstr(std::to_string(descriptor.bits)));
  }
}

// The matcher's tolerances as whole bits, by hand.
TEST(BinaryDescriptor, TolerancesAreSharesOfItsBits) {
  EXPECT_EQ(descriptor_of_bits(128).support_bits(), 37);
  EXPECT_EQ(descriptor_of_bits(256).support_bits(), 75);
  EXPECT_EQ(descriptor_of_bits(512).support_bits(), 150);
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
    SCOPED_TRACE(descriptor.name);
    FeatureOptions options;
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
