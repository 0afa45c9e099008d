#include "pilotage/vision/hamming_distance.h"

#include <bit>
#include <vector>

#include <gtest/gtest.h>

#include "pilotage/base/random.h"

namespace pilotage {
namespace {

using Descriptor = std::vector<std::uint8_t>;

std::vector<Descriptor> random_descriptors(Random& random, std::size_t count, std::size_t bytes) {
  std::vector<Descriptor> descriptors(count, Descriptor(bytes));
  for (Descriptor& descriptor : descriptors) {
    // Few values, so that equal distances are common.
    for (std::uint8_t& byte : descriptor) byte = static_cast<std::uint8_t>(random.below(2) * 0xFF);
  }
  return descriptors;
}

std::vector<const std::uint8_t*> pointers(const std::vector<Descriptor>& descriptors) {
  std::vector<const std::uint8_t*> result;
  for (const Descriptor& descriptor : descriptors) result.push_back(descriptor.data());
  return result;
}

NearestDescriptor nearest_of_all(const Descriptor& query, const std::vector<Descriptor>& candidates) {
  NearestDescriptor nearest;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    std::uint32_t bits = 0;
    for (std::size_t byte = 0; byte < query.size(); ++byte) {
      bits += static_cast<std::uint32_t>(std::popcount(static_cast<unsigned>(query[byte] ^ candidates[i][byte])));
    }
    if (bits < nearest.distance) nearest = {i, bits};
  }
  return nearest;
}

TEST(NearestDescriptorTest, EqualsBruteForce) {
  Random random(seed_from_name("NearestDescriptor"));
  for (const std::size_t bytes : {8U, 16U, 24U, 32U, 64U}) {
    for (const std::size_t count : {1U, 2U, 9U, 25U}) {
      for (int round = 0; round < 50; ++round) {
        const auto candidates = random_descriptors(random, count, bytes);
        const Descriptor query = random_descriptors(random, 1, bytes).front();
        const NearestDescriptor expected = nearest_of_all(query, candidates);
        const NearestDescriptor nearest = nearest_descriptor(query.data(), pointers(candidates).data(), count, bytes);
        EXPECT_EQ(nearest.index, expected.index) << bytes << " " << count;
        EXPECT_EQ(nearest.distance, expected.distance) << bytes << " " << count;
      }
    }
  }
}

TEST(NearestDescriptorTest, CountsEveryBit) {
  for (const std::size_t bytes : {16U, 32U, 64U}) {
    for (std::size_t bit = 0; bit < 8 * bytes; ++bit) {
      const Descriptor query(bytes, 0);
      Descriptor other = query;
      other[bit / 8] = static_cast<std::uint8_t>(1U << bit % 8);
      const std::uint8_t* const candidate = other.data();
      EXPECT_EQ(nearest_descriptor(query.data(), &candidate, 1, bytes).distance, 1U) << bytes << " " << bit;
    }
    const Descriptor none(bytes, 0);
    const Descriptor all(bytes, 0xFF);
    const std::uint8_t* const candidate = all.data();
    EXPECT_EQ(nearest_descriptor(none.data(), &candidate, 1, bytes).distance, 8 * bytes);
  }
}

TEST(NearestDescriptorTest, EqualOnesGiveTheFirst) {
  const Descriptor query(32, 0x0F);
  const Descriptor near(32, 0x0E);
  const Descriptor far(32, 0xF0);
  const std::vector<const std::uint8_t*> candidates{far.data(), near.data(), near.data(), far.data()};
  EXPECT_EQ(nearest_descriptor(query.data(), candidates.data(), candidates.size(), 32).index, 1U);
}

TEST(NearestDescriptorTest, OfNoneIsInfinitelyFar) {
  const Descriptor query(32, 0);
  EXPECT_EQ(nearest_descriptor(query.data(), nullptr, 0, 32).distance, ~0U);
}

}  // namespace
}  // namespace pilotage
