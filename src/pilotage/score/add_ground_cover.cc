#include "pilotage/score/add_ground_cover.h"

#include <cmath>
#include <cstdlib>
#include <limits>

#include "pilotage/matchability/ground_cover.h"
#include "pilotage/raster/elevation.h"
#include "pilotage/raster/gdal_io.h"

namespace pilotage {

void add_ground_cover(const ColorSource& colors, std::optional<double>& white, const TileMatrix& matrix,
                      std::span<const std::int64_t> tile_indices, std::span<TileScores> scores, int threads,
                      const Progress& progress) {
  std::vector<TileScores*> scored;
  std::vector<std::int64_t> indices;
  for (std::size_t i = 0; i < scores.size(); ++i) {
    if (scores[i].status == TileStatus::kTooLittleGround) continue;
    scored.push_back(&scores[i]);
    indices.push_back(tile_indices[i]);
  }
  if (indices.empty()) return;
  if (!white) white = white_of(colors);
  const std::vector<GroundCover> covers = measure_ground_cover(colors, matrix, indices, threads, progress, white);
  for (std::size_t i = 0; i < scored.size(); ++i) {
    scored[i]->vegetation_share = covers[i].vegetation_share;
    scored[i]->water_share = covers[i].water_share;
    scored[i]->aperture = covers[i].aperture;
  }
}

void add_relief(const Ground& ground, std::span<const GroundTile> tiles, std::span<TileScores> scores) {
  constexpr int kSteps = 8;
  if (ground.elevation.empty()) return;
  const Elevation elevation(ground.elevation);
  const CrsTransform transform(ground.crs);
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    if (scores[i].status == TileStatus::kTooLittleGround) continue;
    const Bounds& bounds = tiles[i].bounds;
    double lowest_m = std::numeric_limits<double>::infinity();
    double highest_m = -lowest_m;
    for (int step = 0; step < (kSteps + 1) * (kSteps + 1) && !std::isnan(highest_m); ++step) {
      const auto [row, column] = std::div(step, kSteps + 1);
      const double x_share = static_cast<double>(column) / kSteps;
      const double y_share = static_cast<double>(row) / kSteps;
      const auto point = transform.geodetic_from_map(
          {bounds.min_x_m + x_share * bounds.width_m(), bounds.min_y_m + y_share * bounds.height_m()});
      const double height_m = point ? elevation.amsl_m(*point) : std::numeric_limits<double>::quiet_NaN();
      lowest_m = std::min(lowest_m, height_m);
      highest_m = std::isnan(height_m) ? height_m : std::max(highest_m, height_m);
    }
    scores[i].relief_m = highest_m - lowest_m;
  }
}

}  // namespace pilotage
