#pragma once

#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "pilotage/ground/tile_scores.h"

namespace pilotage {

/// A reason as reports say it of several tiles.
struct ReasonWords {
  ReasonCode code;
  std::string_view what;  ///< "open water"
  std::string_view todo;  ///< What to change, one sentence.
};

const ReasonWords& reason_words(ReasonCode code);

/// Of how many tiles each reason is told; causes before what follows from other things (flat, few features, weak), and
/// of each kind the commonest first. What no tile has is left out. A tile that could not be scored has that reason
/// alone.
using ReasonCounts = std::vector<std::pair<ReasonCode, std::int64_t>>;
ReasonCounts count_reasons(const std::vector<const TileScores*>& tiles);

}  // namespace pilotage
