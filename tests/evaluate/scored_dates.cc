#include "evaluate/scored_dates.h"

#include "testing/temporary_folder.h"
#include <opencv2/core.hpp>

#include "country/synthetic_scene.h"
#include "pilotage/ground/ground_of_rasters.h"
#include "pilotage/raster/gdal_io.h"
#include "pilotage/raster/gray_stretch.h"

namespace pilotage::testing {
namespace {

constexpr double kGsd_m = 0.5;
constexpr int kSidePx = 480;

TileScores score_of(const GraySource& source, const PixelWindow& window) {
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(source.read(window).pixels, mean, deviation);
  TileScores score;
  score.valid_fraction = 1;
  score.gray_variance = deviation[0];
  score.p_correct_fix = std::min(1.0, deviation[0] / 40);
  return score;
}

ScoredDates make_scored_dates(const std::filesystem::path& folder) {
  const Scene scene = make_scene({});
  const Eigen::Vector2d corner = scene.map_from_local({scene.sites.town.x(), scene.sites.town.y() + 120});
  const GeoTransform grid = GeoTransform::north_up(corner.x(), corner.y(), kGsd_m);
  ScoredDates made;
  made.reference = (folder / "reference.tif").string();
  made.other = (folder / "other.tif").string();
  made.moved = (folder / "moved.tif").string();
  write_rgb8_geotiff(made.reference, render_rgb8(scene, SceneEpoch::kFirst, grid, kSidePx, kSidePx), scene.crs());
  Raster later = render_rgb8(scene, SceneEpoch::kSecond, grid, kSidePx, kSidePx);
  write_rgb8_geotiff(made.other, later, scene.crs());
  later.map_from_pixel.origin_x += kMoved_m;
  write_rgb8_geotiff(made.moved, later, scene.crs());

  made.ground.crs = Crs::from_user_input(scene.crs());
  GridLevel level;
  level.matrix = {0, grid, kSidePx, kSidePx, 96, 48};
  level.gsd_m = kGsd_m;
  level.search_radius_px = 40;
  made.ground.levels = {level};
  made.ground.imagery.datasets = {{made.reference, kGsd_m, made.ground.crs.name(), "", kSidePx, kSidePx}};
  made.ground.imagery.own_grid = true;
  cut_all_tiles(made.ground);
  const GraySource source = open_gray(made.reference);
  for (GroundTile& tile : made.ground.tiles) {
    tile.valid_fraction = 1;
    made.scores.push_back(score_of(source, made.ground.window_of(tile)));
  }
  return made;
}

}  // namespace

const ScoredDates& scored_dates() {
  static const TemporaryFolder folder;
  static const ScoredDates made = make_scored_dates(folder.path());
  return made;
}

}  // namespace pilotage::testing
