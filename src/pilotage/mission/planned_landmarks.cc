#include "pilotage/mission/planned_landmarks.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "pilotage/base/error.h"
#include "pilotage/mission/landmark_file.h"
#include "pilotage/raster/elevation.h"
#include "pilotage/raster/gdal_crs.h"

namespace pilotage {
namespace {

/// Whether a point lies on a tile, without looking at all of them.
class PlannedGround {
 public:
  explicit PlannedGround(const std::vector<GroundTile>& tiles) {
    for (const GroundTile& tile : tiles) {
      side_m_ = std::max({side_m_, tile.bounds.width_m(), tile.bounds.height_m()});
    }
    for (const GroundTile& tile : tiles) by_cell_[cell({tile.bounds.min_x_m, tile.bounds.min_y_m})].push_back(&tile);
  }

  bool has(const Eigen::Vector2d& point_m) const {
    const auto [column, row] = cell(point_m);
    for (int neighbour = 0; neighbour < 4; ++neighbour) {
      const auto found = by_cell_.find({column - neighbour % 2, row - neighbour / 2});
      if (found == by_cell_.end()) continue;
      for (const GroundTile* tile : found->second) {
        const Bounds& bounds = tile->bounds;
        if (point_m.x() >= bounds.min_x_m && point_m.x() <= bounds.max_x_m && point_m.y() >= bounds.min_y_m &&
            point_m.y() <= bounds.max_y_m) {
          return true;
        }
      }
    }
    return false;
  }

 private:
  using Cell = std::pair<std::int64_t, std::int64_t>;
  Cell cell(const Eigen::Vector2d& point_m) const {
    return {static_cast<std::int64_t>(std::floor(point_m.x() / side_m_)),
            static_cast<std::int64_t>(std::floor(point_m.y() / side_m_))};
  }

  double side_m_ = 1;  // of the largest tile: one begins in the point's cell or in those left of and below it
  std::map<Cell, std::vector<const GroundTile*>> by_cell_;
};

}  // namespace

MapLandmarks landmarks_on_tiles(const Ground& ground, const MapLandmarks& all, const std::string& path) {
  const CrsTransform transform(ground.crs);
  const PlannedGround planned(ground.tiles);
  MapLandmarks landmarks;
  std::map<std::size_t, std::size_t> numbers;  // of detectors among all, among these
  for (MapLandmark landmark : all.landmarks) {
    const auto point_m = transform.map_from_geodetic(landmark.place);
    if (!point_m || !planned.has(*point_m)) continue;
    const auto [number, first] = numbers.emplace(landmark.detector, landmarks.detectors.size());
    if (first) landmarks.detectors.push_back(all.detectors[landmark.detector]);
    landmark.detector = number->second;
    landmarks.landmarks.push_back(landmark);
  }
  if (landmarks.landmarks.empty()) throw DataError(path + ": none of its landmarks lies on the ground of a tile");
  return landmarks;
}

MapLandmarks read_planned_landmarks(const Ground& ground, const std::string& path) {
  MapLandmarks landmarks = landmarks_on_tiles(ground, read_map_landmarks(path), path);
  if (ground.elevation.empty()) return landmarks;
  Elevation elevation(ground.elevation);
  for (MapLandmark& landmark : landmarks.landmarks) landmark.ground_height_m = elevation.amsl_m(landmark.place);
  return landmarks;
}

}  // namespace pilotage
