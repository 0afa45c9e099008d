#pragma once

#include <cstdint>
#include <vector>

namespace pilotage {

/// One test of a BRIEF descriptor: is the pixel at (x1, y1) darker than the one at (x2, y2)? Offsets from the key
/// point.
struct BriefPair {
  std::int8_t x1;
  std::int8_t y1;
  std::int8_t x2;
  std::int8_t y2;

  bool operator==(const BriefPair&) const = default;
};

inline constexpr int kBriefPatchPx = 31;

/// The seed of the patterns in map databases: part of the file format, so that a map and a frame always agree.
inline constexpr std::uint64_t kBriefPatternSeed = 1;

/// `bits` tests whose points are drawn independently from an isotropic Gaussian of variance S²/25, S = kBriefPatchPx,
/// rounded to pixels; points outside the patch and pairs of equal points are drawn again (M. Calonder, V. Lepetit, C.
/// Strecha, P. Fua, "BRIEF: Binary Robust Independent Elementary Features", ECCV 2010, layout G II). The same for the
/// same seed everywhere.
std::vector<BriefPair> make_brief_pattern(int bits, std::uint64_t seed);

}  // namespace pilotage
