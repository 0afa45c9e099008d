#include "pilotage/mapdb/descriptor_row.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"

namespace pilotage {
namespace {

using ::testing::ElementsAre;

TileDescriptors one_feature(const Feature& feature, int width) {
  TileDescriptors result;
  result.window = {0, 0, width, width};
  result.features.features = {feature};
  result.features.descriptors.assign(static_cast<std::size_t>(result.features.descriptor_bytes), 7);
  return result;
}

TileDescriptors round_trip(const TileDescriptors& descriptors) {
  const EncodedKeypoints encoded = encode_keypoints(descriptors, "here");
  DescriptorRow row;
  row.window = descriptors.window;
  row.count = static_cast<std::int64_t>(descriptors.features.size());
  row.descriptor_bytes = descriptors.features.descriptor_bytes;
  row.ground_base_m = encoded.ground_base_m;
  row.keypoints = encoded.bytes;
  row.descriptors = descriptors.features.descriptors;
  return decode_descriptors(row, descriptors.features.pattern, "file");
}

// The bytes that schemas/pilotage_descriptors.md gives as its example.
TEST(DescriptorRow, BytesAreThoseOfTheSpecification) {
  TileDescriptors d = one_feature({100.5F, 8191.9375F, 3, 0.5F}, 8192);
  d.ground_height_m = {123.4F};
  const EncodedKeypoints encoded = encode_keypoints(d, "here");
  EXPECT_EQ(encoded.ground_base_m, 123);
  EXPECT_THAT(encoded.bytes, ElementsAre(0x48, 0x06, 0xE0, 0xFF, 0x3F, 0x0C, 0x04, 0x00));
}

TEST(DescriptorRow, QuantisationErrorIsHalfAStep) {
  Random random(seed_from_name("DescriptorRow.Quantisation"));
  for (int trial = 0; trial < 2000; ++trial) {
    const int width = trial % 2 == 0 ? 8192 : kMaxMapWindowPx;
    Feature f;
    f.x_px = static_cast<float>(random.uniform(0, width));
    f.y_px = static_cast<float>(random.uniform(0, width));
    f.octave = static_cast<int>(random.below(16));
    TileDescriptors d = one_feature(f, width);
    d.ground_height_m = {static_cast<float>(random.uniform(-430, 8848))};
    const TileDescriptors back = round_trip(d);
    const Feature& g = back.features.features[0];
    EXPECT_NEAR(g.x_px, f.x_px, 1.0 / 32 + 1e-9);
    EXPECT_NEAR(g.y_px, f.y_px, 1.0 / 32 + 1e-9);
    EXPECT_EQ(g.octave, f.octave);
    EXPECT_EQ(g.response, 0) << "is not stored";
    EXPECT_NEAR(back.ground_height_m[0], d.ground_height_m[0], 0.0506);
  }
}

TEST(DescriptorRow, EdgesOfTheLargestWindow) {
  const TileDescriptors back = round_trip(one_feature({65536, 65536, 15, 0}, kMaxMapWindowPx));
  EXPECT_EQ(back.features.features[0].x_px, 65536);
  EXPECT_EQ(back.features.features[0].y_px, 65536);
  EXPECT_EQ(back.features.features[0].octave, 15);
}

TEST(DescriptorRow, UnknownHeights) {
  TileDescriptors d = one_feature({}, 64);
  d.features.features.resize(3);
  d.features.descriptors.resize(3 * static_cast<std::size_t>(d.features.descriptor_bytes));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  d.ground_height_m = {nan, -3000, 3500};
  const TileDescriptors back = round_trip(d);
  EXPECT_TRUE(std::isnan(back.ground_height_m[0]));
  EXPECT_NEAR(back.ground_height_m[1], -3000, 0.01);
  EXPECT_NEAR(back.ground_height_m[2], 3500, 0.01);
  d.ground_height_m = {nan, nan, nan};
  EXPECT_TRUE(round_trip(d).ground_height_m.empty());
  d.ground_height_m = {0, 0, 7000};
  EXPECT_THROW(encode_keypoints(d, "here"), UsageError);
}

TEST(DescriptorRow, RefusesWhatCannotBeStored) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  for (const Feature& bad : {Feature{-0.1F, 0, 0, 0}, Feature{0, 64.1F, 0, 0}, Feature{nan, 0, 0, 0},
                             Feature{0, inf, 0, 0}, Feature{0, 0, 16, 0}, Feature{0, 0, -1, 0}}) {
    EXPECT_THROW(encode_keypoints(one_feature(bad, 64), "here"), UsageError);
  }
  TileDescriptors d = one_feature({}, 64);
  d.features.descriptor_bytes = 33;
  EXPECT_THROW(encode_keypoints(d, "here"), UsageError);
  d.features.descriptor_bytes = 32;
  EXPECT_THROW(encode_keypoints(d, "here"), UsageError);
  d = one_feature({}, 64);
  d.ground_height_m = {1, 2};
  EXPECT_THROW(encode_keypoints(d, "here"), UsageError);
  d.ground_height_m = {inf};
  EXPECT_THROW(encode_keypoints(d, "here"), UsageError);
}

}  // namespace
}  // namespace pilotage
