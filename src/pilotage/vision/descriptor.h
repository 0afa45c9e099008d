#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include "pilotage/base/options.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// Which pixels a descriptor compares (vision/feature_descriptor.cc).
enum class DescriptorPattern {
  kGround,  ///< Tests learned on ground at two dates (vision/ground_pattern.h).
  kOrb,     ///< The 256 pairs of ORB, learned on pictures of streets and rooms (E. Rublee et al., ICCV 2011), upright.
  kBrief,   ///< Pairs drawn from an isotropic Gaussian (vision/brief_pattern.h).
};

inline EnumNames<DescriptorPattern> enum_names(DescriptorPattern) {
  return {
      {DescriptorPattern::kGround, "ground"}, {DescriptorPattern::kOrb, "orb"}, {DescriptorPattern::kBrief, "brief"}};
}

/// A binary descriptor: what a map may store, a frame be described with, and the Hamming search compare.
struct BinaryDescriptor {
  DescriptorPattern pattern;
  int bits;      ///< A multiple of 64.
  int reach_px;  ///< Pixels to each side of the feature on which it depends.
  // How alike two descriptors of the same ground are a year apart, as the largest share of bits that differ.
  double vote_distance;       ///< Of a pair that votes for a displacement.
  double fit_distance;        ///< Of a pair that moves a candidate's placement.
  double support_distance;    ///< Of a pair that counts as found.
  double survival_distance;   ///< Of a feature that a second date does not contradict (registration/feature_fates.h).
  double lookalike_distance;  ///< Of two features of one map that look like each other (matchability/self_votes.h).

  int bytes() const { return bits / 8; }
  /// Largest number of differing bits of a pair that counts as found.
  int support_bits() const { return static_cast<int>(bits * support_distance); }
  /// Likewise of one that survives.
  int survival_bits() const { return static_cast<int>(bits * survival_distance); }
  /// Likewise of two that look like each other.
  int lookalike_bits() const { return static_cast<int>(bits * lookalike_distance); }
};

/// All of them, and the one place to add another: options, files, search and matcher go by this list. Only a pattern of
/// a new kind is more than a row: its code goes into vision/feature_descriptor.cc. The reach of ORB's and BRIEF's is
/// that of their pairs and of the Gaussian of 7 × 7 pixels before them.
inline constexpr std::array<BinaryDescriptor, 6> kBinaryDescriptors{{
    {DescriptorPattern::kGround, 64, 15, 104.0 / 256, 100.0 / 256, 96.0 / 256, 86.0 / 256, 76.0 / 256},
    {DescriptorPattern::kGround, 128, 15, 104.0 / 256, 100.0 / 256, 96.0 / 256, 86.0 / 256, 76.0 / 256},
    {DescriptorPattern::kGround, 256, 15, 104.0 / 256, 100.0 / 256, 96.0 / 256, 86.0 / 256, 76.0 / 256},
    {DescriptorPattern::kOrb, 256, 16, 90.0 / 256, 85.0 / 256, 75.0 / 256, 64.0 / 256, 75.0 / 256},
    {DescriptorPattern::kBrief, 128, 18, 90.0 / 256, 85.0 / 256, 75.0 / 256, 64.0 / 256, 75.0 / 256},
    {DescriptorPattern::kBrief, 512, 18, 90.0 / 256, 85.0 / 256, 75.0 / 256, 64.0 / 256, 75.0 / 256},
}};
inline constexpr DescriptorPattern kDefaultDescriptorPattern = DescriptorPattern::kGround;
inline constexpr int kDefaultDescriptorBits = 128;
/// What `--descriptor-bits` says of itself.
inline constexpr std::string_view kDescriptorBitsHelp =
    "Length of a descriptor: 64, 128 or 256 of ground, 256 of orb, 128 or 512 of brief.";

/// The lengths there are in words of 64 bits, ascending.
inline constexpr std::array<int, 4> kDescriptorWords{1, 2, 4, 8};
inline constexpr int kLeastDescriptorBits = 64 * kDescriptorWords.front();
inline constexpr int kMostDescriptorBits = 64 * kDescriptorWords.back();

/// Whether some descriptor has this length.
constexpr bool is_descriptor_length(int bits) {
  return std::any_of(kDescriptorWords.begin(), kDescriptorWords.end(), [&](int words) { return 64 * words == bits; });
}

/// The descriptor of this pattern and length, or nullptr.
constexpr const BinaryDescriptor* find_descriptor(DescriptorPattern pattern, int bits) {
  for (const BinaryDescriptor& descriptor : kBinaryDescriptors) {
    if (descriptor.pattern == pattern && descriptor.bits == bits) return &descriptor;
  }
  return nullptr;
}

/// The same; throws UsageError naming the lengths that the pattern has.
const BinaryDescriptor& descriptor_of(DescriptorPattern pattern, int bits);

/// "ground_128": for tables, tests and names of files.
std::string descriptor_name(const BinaryDescriptor& descriptor);

/// All lengths in bytes, for messages: "8, 16, 32, 64".
std::string descriptor_byte_lengths();

static_assert(std::all_of(kBinaryDescriptors.begin(), kBinaryDescriptors.end(),
                          [](const auto& descriptor) {
                            return is_descriptor_length(descriptor.bits) &&
                                   find_descriptor(descriptor.pattern, descriptor.bits) == &descriptor;
                          }),
              "lengths are those of kDescriptorWords, and no two descriptors are the same");

}  // namespace pilotage

#pragma GCC visibility pop
