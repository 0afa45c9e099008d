#pragma once

#include <string>
#include <vector>

#include "pilotage/ground/ground.h"
#include "pilotage/ground/tile_scores.h"
#include "pilotage/ground/tile_table.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// The tiles of a ground with their scores: scores[i] is of ground.tiles[i]. What it is made of must outlive it.
struct ScoreTable {
  /// Throws DataError when there is not one score for each tile, or the ground is none: tiles that do not ascend, or
  /// lie on a level that it does not have.
  ScoreTable(const Ground& ground, const std::vector<TileScores>& scores);

  const Ground& ground;
  const std::vector<TileScores>& scores;
};

/// One level of a score table: its tiles are those of the ground whose level it is.
struct LevelScores {
  /// Throws UsageError when the ground has no such level.
  LevelScores(const ScoreTable& table, int level);

  const Ground& ground;
  const GridLevel& level;
  const std::vector<TileScores>& scores;  ///< scores[i] is of ground.tiles[i], of whichever level.

  const TileMatrix& matrix() const { return level.matrix; }
  bool has(std::size_t tile) const { return ground.tiles[tile].level == level.matrix.level; }
};

/// The scores of a ground's tiles out of the rows of a table, in the order of the tiles. Throws DataError, naming the
/// table and where the ground is from, when its rows are not of these tiles, one for each.
std::vector<TileScores> scores_of(const Ground& ground, std::vector<TileRow> rows, const std::string& table,
                                  const std::string& source);

}  // namespace pilotage

#pragma GCC visibility pop
