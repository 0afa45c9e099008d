#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pilotage/geo/geodetic_point.h"
#include "pilotage/ground/score_table.h"
#include "pilotage/matchability/reason_words.h"

namespace pilotage {

/// Numbers of tiles by class (verdict/tile_class.h).
struct ClassCounts {
  std::int64_t go = 0;
  std::int64_t marginal = 0;
  std::int64_t no_go = 0;
  std::int64_t not_known = 0;  ///< Nothing was measured that decides.

  std::int64_t all() const { return go + marginal + no_go + not_known; }
};

/// Some ground in numbers. Each tile stands for its cell, the square of one stride around its centre.
struct AreaStatistics {
  ClassCounts tiles;
  double area_km2 = 0;              ///< Of all their cells.
  double median_p_correct_fix = 0;  ///< Over the tiles that have one; NaN when none has.
  ReasonCounts reasons;             ///< Of the tiles that are not go.

  /// Of the area, 0 … 1; NaN without a tile.
  double share(std::int64_t of_tiles) const;
};

AreaStatistics area_statistics(const std::vector<const TileScores*>& tiles, double cell_km2);

/// A square of the kilometre grid of the ground's CRS.
struct SquareKilometre {
  std::int64_t east_km = 0;  ///< Of its lower left corner, whole kilometres of the CRS.
  std::int64_t north_km = 0;
  GeodeticPoint center;
  AreaStatistics statistics;  ///< Of the tiles whose centre lies in it.

  std::string name() const { return "E" + std::to_string(east_km) + " N" + std::to_string(north_km); }
};

/// The squares that hold a tile, from north to south, then from west to east; left and lower edges belong to a square.
/// The ground has one level, in metres.
std::vector<SquareKilometre> square_kilometres(const ScoreTable& table);

/// The area of a tile's cell.
double cell_km2(const GridLevel& level);

/// How far the tile that is farthest from go ground lies from it: the largest distance from the centre of a tile to the
/// centre of the nearest go tile, along the grid as the crow flies, whatever lies between. 0 when all are go; NaN when
/// none is. One level.
double farthest_from_go_m(const ScoreTable& table);

}  // namespace pilotage
