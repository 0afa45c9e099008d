#include "pilotage/replay/predicted_tiles.h"

#include <algorithm>
#include <cmath>

#include "pilotage/geo/local_frame.h"

namespace pilotage {
namespace {

/// A column of the map and where its number belongs.
struct PredictedColumn {
  const char* name;
  double TileScores::*member;
};
constexpr PredictedColumn kPredictedColumns[] = {
    {"p_correct_fix", &TileScores::p_correct_fix},         {"level_sigma", &TileScores::level_sigma},
    {"map_features", &TileScores::map_features},           {"vote_noise", &TileScores::vote_noise},
    {"relative_contrast", &TileScores::relative_contrast}, {"frieden_deficit", &TileScores::frieden_deficit},
    {"gray_variance", &TileScores::gray_variance}};

std::optional<int> level_for(const MapReader& map, double height_agl_m) {
  for (const MapLevel& level : map.levels()) {
    if (height_agl_m >= level.min_agl_m && height_agl_m <= level.max_agl_m) return level.matrix.level;
  }
  return std::nullopt;
}

}  // namespace

bool PredictedTiles::has_p() const {
  const auto& columns = map_.tile_columns();
  return std::any_of(columns.begin(), columns.end(),
                     [](const MapColumn& column) { return column.name == kPredictedColumns[0].name; });
}

std::optional<PredictedTile> PredictedTiles::under(GeodeticPoint point, double height_agl_m) {
  const LocalFrame frame(point);
  double least_m = std::numeric_limits<double>::infinity();
  std::optional<MapTile> nearest;
  for (const NearTile& near : map_.tiles_near(point, 0, level_for(map_, height_agl_m))) {
    const double distance_m = frame.enu_from_geodetic(near.tile.center).head<2>().norm();
    if (distance_m >= least_m) continue;
    least_m = distance_m;
    nearest = near.tile;
  }
  if (!nearest) return std::nullopt;
  return predicted(*nearest);
}

PredictedTile PredictedTiles::predicted(const MapTile& tile) {
  const auto found = known_.find(tile.tile_id);
  if (found != known_.end()) return found->second;
  PredictedTile result{tile, {}};
  const auto values = map_.tile_values(tile.tile_id);
  const auto& columns = map_.tile_columns();
  for (std::size_t i = 0; values && i < columns.size() && i < values->size(); ++i) {
    const double* number = std::get_if<double>(&(*values)[i]);
    if (number == nullptr) continue;
    for (const PredictedColumn& known : kPredictedColumns) {
      if (columns[i].name == known.name) result.scores.*known.member = *number;
    }
  }
  const double p = result.scores.p_correct_fix;
  if (!(p >= 0 && p <= 1)) result.scores.p_correct_fix = std::numeric_limits<double>::quiet_NaN();
  return known_.emplace(tile.tile_id, result).first->second;
}

}  // namespace pilotage
