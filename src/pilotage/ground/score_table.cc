#include "pilotage/ground/score_table.h"

#include <utility>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

std::string counts(std::size_t scores, std::size_t tiles) {
  return std::to_string(scores) + " scores, " + std::to_string(tiles) + " tiles";
}

void check_tiles(const Ground& ground) {
  for (std::size_t i = 0; i < ground.tiles.size(); ++i) {
    const GroundTile& tile = ground.tiles[i];
    if (tile.level < 0 || tile.level >= std::ssize(ground.levels)) {
      throw DataError("tile " + std::to_string(tile.tile_id) + " lies on level " + std::to_string(tile.level) +
                      ", which the plan does not have");
    }
    if (i > 0 && ground.tiles[i - 1].tile_id >= tile.tile_id) {
      throw DataError("tile " + std::to_string(tile.tile_id) + " is out of order, or a duplicate in the plan");
    }
  }
}

const GridLevel& level_named(const Ground& ground, int level) {
  if (level >= 0 && level < std::ssize(ground.levels)) return ground.levels[static_cast<std::size_t>(level)];
  throw UsageError("level = " + std::to_string(level) + ": the plan has " + std::to_string(ground.levels.size()) +
                   " level(s)");
}

}  // namespace

ScoreTable::ScoreTable(const Ground& all_tiles, const std::vector<TileScores>& of_tiles)
    : ground(all_tiles), scores(of_tiles) {
  check_tiles(ground);
  if (scores.size() == ground.tiles.size()) return;
  throw DataError("the scores are not those of the ground's tiles (" + counts(scores.size(), ground.tiles.size()) +
                  ")");
}

LevelScores::LevelScores(const ScoreTable& table, int number)
    : ground(table.ground), level(level_named(table.ground, number)), scores(table.scores) {}

std::vector<TileScores> scores_of(const Ground& ground, std::vector<TileRow> rows, const std::string& table,
                                  const std::string& source) {
  std::vector<TileScores> scores;
  scores.reserve(rows.size());
  for (TileRow& row : rows) {
    const bool same = scores.size() < ground.tiles.size() && [&](const GroundTile& tile) {
      return row.tile.tile_id == tile.tile_id && row.tile.level == tile.level && row.tile.cell() == tile.cell();
    }(ground.tiles[scores.size()]);
    if (!same) break;
    scores.push_back(std::move(row.score));
  }
  if (scores.size() == ground.tiles.size() && scores.size() == rows.size()) return scores;
  throw DataError(table + ": is of other tiles than " + source + " (" + counts(rows.size(), ground.tiles.size()) +
                  "); score the plan again");
}

}  // namespace pilotage
