#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pilotage/evaluate/evaluated_tiles.h"

namespace pilotage::testing {

/// A piece of the synthetic country (town, river, fields) at two dates, 0.5 m/px, as files, and its scores: what an
/// evaluation is made of.
struct ScoredDates {
  Ground ground;                   ///< Tiles of 96 px every 48 px, searched ± 40 px.
  std::vector<TileScores> scores;  ///< Of its tiles: gray_variance only, p_correct_fix set to it.
  std::string reference;
  std::string other;
  std::string moved;  ///< The other date whose georeference lies kMoved_m to the east of the truth.

  LevelScores judged() const { return {ScoreTable(ground, scores), 0}; }
};

inline constexpr double kMoved_m = 7;

/// Made once, in a folder that lasts as long as the program.
const ScoredDates& scored_dates();

}  // namespace pilotage::testing
