#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>

#include "pilotage/ground/tile_scores.h"
#include "pilotage/mapdb/map_reader.h"

namespace pilotage {

/// A stored tile and what was predicted of it.
struct PredictedTile {
  MapTile tile;
  TileScores scores;  ///< As the map has them; NaN where it does not say.

  double p() const { return scores.p_correct_fix; }
};

/// The tiles of a map by place.
class PredictedTiles {
 public:
  explicit PredictedTiles(MapReader& map) : map_(map) {}

  /// The stored tile with the nearest centre among those that hold the point, of the level for this height (of all
  /// levels where none serves it or it is NaN); nothing over ground that is not stored.
  std::optional<PredictedTile> under(GeodeticPoint point, double height_agl_m);

 private:
  PredictedTile predicted(const MapTile& tile);

  MapReader& map_;
  std::map<std::int64_t, PredictedTile> known_;
};

}  // namespace pilotage
