#pragma once

#include <limits>
#include <string>
#include <vector>

#include "pilotage/geo/tile_matrix.h"
#include "pilotage/ground/ground.h"
#include "pilotage/ground/tile_scores.h"

namespace pilotage {

/// What a tile's numbers have to be held against.
struct ReasonContext {
  TileMatrix matrix;  ///< Of the tile's level: its size in pixels, and where right and down lead on the ground.
  double metres_per_unit = 1;  ///< Of the grid's CRS; NaN where it counts degrees: distances are then told in pixels.
  double min_agl_m = std::numeric_limits<double>::quiet_NaN();  ///< Lowest flight over the level; NaN: not known.
  double low_p = 0.5;    ///< Below this P a tile is told all that speaks against it.
  double watch_p = 0.8;  ///< Below this P it is told what is plain.
};

/// Of a level of a ground.
ReasonContext reason_context(const Crs& crs, const GridLevel& level);

/// One reason.
struct Reason {
  ReasonCode code;
  std::string text;   ///< A sentence for a planner, with the number behind it.
  double weight = 0;  ///< How far the number is beyond its threshold; 1 = at it.
};

/// Why a tile is not, or may not be, recognised: at most three reasons, the heaviest first (equal ones in the order of
/// ReasonCode).
///
///  - too little ground, or flat: that alone;
///  - P below `low_p`: every reason of weight 0.8 or more, and kWeak when there is none;
///  - P below `watch_p`, or not known: every reason of weight 1 or more;
///  - otherwise none.
///
/// Numbers that were not measured (NaN) give no reason. Thresholds: docs/methods/reasons.md.
std::vector<Reason> tile_reasons(const TileScores& score, const ReasonContext& context);

/// The sentences, one after the other.
std::string reasons_text(const std::vector<Reason>& reasons);

/// The codes of tile_reasons, as TileScores::reasons holds them.
std::vector<ReasonCode> reason_codes(const TileScores& score, const ReasonContext& context);

}  // namespace pilotage
