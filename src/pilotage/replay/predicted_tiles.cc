#include "pilotage/replay/predicted_tiles.h"

#include "pilotage/geo/local_frame.h"
#include "pilotage/ground/measures.h"

namespace pilotage {
namespace {

std::optional<int> level_for(const MapReader& map, double height_agl_m) {
  for (const MapLevel& level : map.levels()) {
    if (height_agl_m >= level.min_agl_m && height_agl_m <= level.max_agl_m) return level.matrix.level;
  }
  return std::nullopt;
}

}  // namespace

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
    if (const Measure* measure = find_measure(columns[i].name)) measure->set(result.scores, *number);
  }
  if (!(result.p() >= 0 && result.p() <= 1)) result.scores.p_correct_fix = std::numeric_limits<double>::quiet_NaN();
  return known_.emplace(tile.tile_id, result).first->second;
}

}  // namespace pilotage
