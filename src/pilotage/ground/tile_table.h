#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pilotage/ground/tile_scores.h"
#include "pilotage/ground/ground.h"

namespace pilotage {

/// A tile with its scores: one row of tiles.csv.
struct TileRow {
  GroundTile tile;
  std::int64_t min_col_px = 0;  ///< First column of the tile in the grid of its level.
  std::int64_t min_row_px = 0;
  TileScore score;
};

/// The rows of a plan: `scores` by tile_id; every score must name a tile of the plan (DataError). Tiles without a score
/// are left out. Ascending tile_id.
std::vector<TileRow> tile_rows(const Ground& ground, std::span<const TileScore> scores);

/// One measured number of a tile. This one list drives the columns of tiles.csv, the bands of scores.tif, the columns
/// of the map's `tiles` layer and the report.
struct ScoreColumn {
  std::string name;                             ///< snake_case with the unit as suffix.
  std::string unit;                             ///< "gray levels", "px", or "" for a plain number.
  std::string description;                      ///< One line.
  std::function<double(const TileScore&)> get;  ///< NaN = not measured or not defined.
  std::function<void(TileScore&, double)> set;
};

/// gray_variance, frieden_entropy, frieden_deficit, then the surface numbers as clean_… and degraded_…, then what a
/// second date says as epoch_…, ground cover and relief, then what p_correct_fix is made of and itself; the order is
/// part of the file format.
const std::vector<ScoreColumn>& score_columns();

/// The column of a name, or nullptr.
const ScoreColumn* find_score_column(std::string_view name);

std::string reason_words(const TileScore& score);      ///< The codes of its reasons, joined by semicolons.
std::string_view tile_status_name(TileStatus status);  ///< "scored", "too_little_ground" or "flat".

/// tiles.csv: a header line, then one line per row; comma separated, no quotes, "\n". Numbers are the shortest text
/// that reads back as the same double; NaN is an empty cell.
std::string tile_table_to_csv(std::span<const TileRow> rows);

/// Reads what tile_table_to_csv writes; rows come back equal (a tile's route distance and offset are not in the file
/// and read as 0). Columns may stand in any order; unknown ones are ignored, so that a later version's file can be
/// read; a missing, repeated or malformed one, tile_ids that do not ascend, or a cell that is no number throws
/// DataError with `name`, the line and the column.
std::vector<TileRow> tile_table_from_csv(const std::string& name, std::string_view text);

}  // namespace pilotage
