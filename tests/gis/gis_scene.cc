#include "gis/gis_scene.h"

#include <algorithm>

#include "raster/raster_maker.h"

#include "pilotage/base/random.h"
#include "pilotage/base/text.h"

namespace pilotage::testing {

ReportInput gis_scene(GeodeticPoint origin, bool two_levels) {
  ReportSceneOptions options;
  options.origin = origin;
  options.turn_deg = 0;
  options.matchable_from = 0.3;
  options.matchable_to = 0.5;
  options.tiles_along = 14;
  ReportInput input = report_scene(options);
  input.mission.ground.crs =
      Crs::from_user_input("+proj=aeqd +datum=WGS84 +units=m +no_defs +lat_0=" + format_number(origin.lat_deg) +
                           " +lon_0=" + format_number(origin.lon_deg));
  if (!two_levels) {
    const auto upper = [](const auto& entry) { return entry.level > 0; };
    std::erase_if(input.mission.ground.tiles, upper);
    input.mission.flight.places.resize(input.mission.ground.tiles.size());
    input.scores.resize(input.mission.ground.tiles.size());
    const auto tiles = static_cast<std::int64_t>(input.mission.ground.tiles.size());
    std::erase_if(input.selection.tile_ids, [&](std::int64_t id) { return id >= tiles; });
    input.mission.ground.levels.resize(1);
  }
  Random random(3);
  for (std::size_t i = 0; i < input.scores.size(); ++i) {
    TileScores& score = input.scores[i];
    if (score.status == TileStatus::kScored && input.mission.ground.tiles[i].tile_id % 9 != 0) {
      score.p_correct_fix = random.uniform();
    }
  }
  input.selection.probability = RouteProbability{0.93, 0.9, 41.5, 0.0021, WorstStretch{1, 300, 520, 0.04}, {}};
  for (LegStatus& leg : input.selection.legs) {
    leg.p_within_limit = 0.98;
    leg.p_fix = 0.9;
  }
  return input;
}

ReportInput with_imagery(ReportInput scene, const std::filesystem::path& folder) {
  constexpr double kPixel_m = 2;
  Ground& ground = scene.mission.ground;
  Bounds bounds;
  for (const GroundTile& tile : ground.tiles) {
    bounds.extend({tile.bounds.min_x_m, tile.bounds.min_y_m});
    bounds.extend({tile.bounds.max_x_m, tile.bounds.max_y_m});
  }
  RasterSpec spec;
  spec.bands = 3;
  spec.width = static_cast<int>(bounds.width_m() / kPixel_m) + 1;
  spec.height = static_cast<int>(bounds.height_m() / kPixel_m) + 1;
  spec.srs = ground.crs.wkt();
  spec.place = GeoTransform::north_up(bounds.min_x_m, bounds.max_y_m, kPixel_m);
  ground.imagery.datasets.front().dataset = make_raster(folder / "valley.tif", spec);
  ground.imagery.datasets.front().gsd_m = kPixel_m;
  return scene;
}

}  // namespace pilotage::testing
