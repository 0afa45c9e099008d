#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#pragma GCC visibility push(default)

namespace pilotage {

/// Which pixels a descriptor compares (vision/feature_descriptor.cc).
enum class DescriptorPattern {
  kOrb,    ///< The learned 256 pairs of ORB (E. Rublee et al., ICCV 2011), as cv::ORB computes them.
  kBrief,  ///< Pairs drawn from an isotropic Gaussian (vision/brief_pattern.h), as many as there are bits.
};

/// A binary descriptor: what a map may store, a frame be described with, and the Hamming search compare.
struct BinaryDescriptor {
  std::string_view name;
  int bits;  ///< A multiple of 64. Its name in options, in map_info and in rows of descriptors, so no two have the
             ///< same.
  DescriptorPattern pattern;
  int pattern_radius_px;  ///< Pixels that the upright pattern reaches from the feature.
  // How alike two descriptors of the same ground are a year apart, as the largest share of bits that differ.
  double vote_distance;     ///< Of a pair that votes for a displacement.
  double fit_distance;      ///< Of a pair that moves a candidate's placement.
  double support_distance;  ///< Of a pair that counts as found.

  int bytes() const { return bits / 8; }
  /// Largest number of differing bits of a pair that counts as found.
  int support_bits() const { return static_cast<int>(bits * support_distance); }
};

/// All of them, and the one place to add another: options, files, search and matcher go by this list. Only a pattern of
/// a new kind is more than a row: its code goes into vision/feature_descriptor.cc.
inline constexpr std::array<BinaryDescriptor, 3> kBinaryDescriptors{{
    {"brief_128", 128, DescriptorPattern::kBrief, 15, 90.0 / 256, 85.0 / 256, 75.0 / 256},
    {"brief_256", 256, DescriptorPattern::kOrb, 13, 90.0 / 256, 85.0 / 256, 75.0 / 256},
    {"brief_512", 512, DescriptorPattern::kBrief, 15, 90.0 / 256, 85.0 / 256, 75.0 / 256},
}};
inline constexpr int kDefaultDescriptorBits = 256;
/// What `--descriptor-bits` says of itself.
inline constexpr std::string_view kDescriptorBitsHelp =
    "Length of a descriptor: 128, 256 or 512. 256 is ORB's pattern, the others are BRIEF's.";

inline constexpr int kLeastDescriptorBits =
    std::min_element(kBinaryDescriptors.begin(), kBinaryDescriptors.end(),
                     [](const auto& a, const auto& b) { return a.bits < b.bits; }) -> bits;
inline constexpr int kMostDescriptorBits =
    std::max_element(kBinaryDescriptors.begin(), kBinaryDescriptors.end(),
                     [](const auto& a, const auto& b) { return a.bits < b.bits; }) -> bits;

/// The descriptor of this length, or nullptr.
constexpr const BinaryDescriptor* find_descriptor(int bits) {
  for (const BinaryDescriptor& descriptor : kBinaryDescriptors) {
    if (descriptor.bits == bits) return &descriptor;
  }
  return nullptr;
}

/// The same; throws UsageError naming the lengths there are.
const BinaryDescriptor& descriptor_of_bits(int bits);

/// The lengths there are, for messages: "128, 256, 512" in bits with unit = 1, "16, 32, 64" in bytes with 8.
std::string descriptor_lengths(int bits_per_unit);

static_assert(std::all_of(kBinaryDescriptors.begin(), kBinaryDescriptors.end(),
                          [](const auto& descriptor) {
                            return descriptor.bits % 64 == 0 && find_descriptor(descriptor.bits) == &descriptor;
                          }),
              "lengths are whole words, and no two descriptors have the same");

}  // namespace pilotage

#pragma GCC visibility pop
