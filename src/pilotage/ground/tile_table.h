#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pilotage/ground/ground.h"
#include "pilotage/ground/measures.h"
#include "pilotage/ground/tile_scores.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// A tile with its scores: one row of tiles.csv.
struct TileRow {
  GroundTile tile;
  std::int64_t min_col_px = 0;  ///< First column of the tile in the grid of its level.
  std::int64_t min_row_px = 0;
  TileScores score;
};

std::string reason_words(const TileScores& score);     ///< The codes of its reasons, joined by semicolons.
std::string_view tile_status_name(TileStatus status);  ///< "scored", "too_little_ground" or "flat".

/// A ground's tiles as rows; scores[i] is of ground.tiles[i].
std::vector<TileRow> tile_rows(const Ground& ground, std::vector<TileScores> scores);

/// tiles.csv: a header line, then one line per row; comma separated, no quotes, "\n". Numbers are the shortest text
/// that reads back as the same double; NaN is an empty cell.
std::string tile_table_to_csv(std::span<const TileRow> rows);

/// The same of all tiles of a ground, without making rows of them first; scores[i] is of ground.tiles[i].
std::string tile_table_to_csv(const Ground& ground, std::span<const TileScores> scores);

/// Reads what tile_table_to_csv writes; rows come back equal (a tile's route distance and offset are not in the file
/// and read as 0). Columns may stand in any order; unknown ones are ignored, so that a later version's file can be
/// read; a missing, repeated or malformed one, tile_ids that do not ascend, or a cell that is no number throws
/// DataError with `name`, the line and the column.
std::vector<TileRow> tile_table_from_csv(const std::string& name, std::string_view text);

}  // namespace pilotage

#pragma GCC visibility pop
