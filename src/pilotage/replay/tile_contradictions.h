#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pilotage/geo/geodetic_point.h"

namespace pilotage {

/// Of discoveries of the refresh list this share is expected to be by chance.
inline constexpr double kFalseDiscoveryRate = 0.1;

/// How often a tile was flown over, and how often a fix came: frames over one tile in a row are one pass, which counts
/// as won when any of them gave a right fix, because they share the ground and its fate.
struct FlownTile {
  std::int64_t tile_id = 0;
  GeodeticPoint center;
  double p = 0;
  std::int64_t passes = 0;
  std::int64_t won = 0;
};

struct Contradiction {
  FlownTile tile;
  /// P of as few won passes, or fewer, if each is won with the tile's P.
  double chance = 1;
  bool refresh = false;  ///< Holds against all tiles that were flown over (Benjamini and Hochberg).
};

/// The tiles whose passes were lost more often than their P lets expect.
struct Contradictions {
  std::int64_t tiles = 0;               ///< That were flown over and have a P.
  double expected_below_5_percent = 0;  ///< So many tiles have a chance of at most 0.05 when every P is true.
  std::vector<Contradiction> suspects;  ///< Chance at most 0.05, the smallest first; the refresh list among them.
};

/// Y. Benjamini, Y. Hochberg, "Controlling the false discovery rate", J. R. Stat. Soc. B 57, 1995, at
/// kFalseDiscoveryRate; binomial tails. Throws UsageError unless 0 ≤ won ≤ passes and 0 ≤ p ≤ 1.
Contradictions find_contradictions(std::span<const FlownTile> tiles);

/// P of at most `most` successes in `trials`.
double binomial_at_most(std::int64_t most, std::int64_t trials, double p);

}  // namespace pilotage
