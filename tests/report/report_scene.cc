#include "report/report_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>

#include "pilotage/base/random.h"
#include "pilotage/geo/local_frame.h"

namespace pilotage::testing {
namespace {

constexpr double kGsd_m = 0.6;
constexpr int kTile_px = 256;
constexpr int kStride_px = 128;
constexpr double kStride_m = kStride_px * kGsd_m;
constexpr double kSpeed_mps = 28;
constexpr int kImageScale = 8;  // overview pixel = 8 grid pixels

TileMatrix matrix_of(const ReportSceneOptions& options) {
  TileMatrix matrix;
  matrix.grid_width_px = (options.tiles_across - 1) * kStride_px + kTile_px;
  matrix.grid_height_px = (options.tiles_along - 1) * kStride_px + kTile_px;
  matrix.tile_size_px = kTile_px;
  matrix.stride_px = kStride_px;
  matrix.map_from_pixel = GeoTransform::north_up(1000, 9000, kGsd_m);
  return matrix;
}

Raster draw_ground(const TileMatrix& matrix) {
  Random random(7);
  Raster raster;
  const cv::Size size(static_cast<int>(matrix.grid_width_px / kImageScale),
                      static_cast<int>(matrix.grid_height_px / kImageScale));
  raster.pixels = cv::Mat(size, CV_8UC3, cv::Scalar(96, 112, 64));
  raster.valid = cv::Mat(size, CV_8UC1, cv::Scalar(255));
  for (int i = 0; i < 260; ++i) {
    const cv::Point corner(static_cast<int>(random.below(static_cast<unsigned>(size.width))),
                           static_cast<int>(random.below(static_cast<unsigned>(size.height))));
    const cv::Size box(8 + static_cast<int>(random.below(30)), 8 + static_cast<int>(random.below(30)));
    const cv::Scalar color(random.uniform(60, 200), random.uniform(70, 190), random.uniform(50, 150));
    cv::rectangle(raster.pixels, cv::Rect(corner, box), color, cv::FILLED);
  }
  cv::line(raster.pixels, {0, size.height / 3}, {size.width, size.height / 2}, {225, 225, 215}, 2);
  cv::ellipse(raster.pixels, {size.width / 2, size.height * 2 / 3}, {size.width / 2, 40}, 10, 0, 360, {30, 50, 80},
              cv::FILLED);
  for (auto& pixel : cv::Mat_<cv::Vec3b>(raster.pixels)) {
    for (int channel = 0; channel < 3; ++channel) {
      pixel[channel] = cv::saturate_cast<std::uint8_t>(pixel[channel] + random.uniform(-9, 9));
    }
  }
  raster.valid(cv::Rect(0, 0, size.width / 5, size.height / 9)).setTo(0);
  raster.map_from_pixel = GeoTransform::north_up(1000, 9000, kGsd_m * kImageScale);
  return raster;
}

}  // namespace

Crs local_crs(const std::string& name) {
  return Crs::from_user_input("LOCAL_CS[\"" + name + "\",UNIT[\"metre\",1],AXIS[\"x\",EAST],AXIS[\"y\",NORTH]]");
}

namespace {

TileScores score_of(const GroundTile& tile, Random& random) {
  TileScores score;
  score.valid_fraction = tile.valid_fraction;
  if (tile.valid_fraction < 0.5) {
    score.status = TileStatus::kTooLittleGround;
    return score;
  }
  score.gray_variance = 20 + 12 * std::sin(static_cast<double>(tile.row) / 5) + random.uniform(-4, 4);
  if (random.uniform() < 0.01) {
    score.status = TileStatus::kFlat;
    score.gray_variance = 0;
    return score;
  }
  score.frieden_deficit = std::pow(score.gray_variance / 110, 2);
  const double pixels = kTile_px * kTile_px;
  score.frieden_entropy = std::numbers::e * (1 - (1 + score.frieden_deficit) / pixels);
  score.clean.peak = 1;
  score.clean.rival = random.uniform(0.3, 0.7);
  score.clean.margin = score.clean.peak - score.clean.rival;
  score.clean.rival_ratio = score.clean.rival;
  score.clean.psr = random.uniform(5, 14);
  score.clean.rivals = std::floor(random.uniform(0, 3));
  score.degraded = score.clean;
  score.degraded.peak = 0.6;
  score.degraded.margin = 0.012 * (score.gray_variance - 10) + random.uniform(-0.05, 0.05);
  score.degraded.rival = score.degraded.peak - score.degraded.margin;
  score.degraded.rival_ratio = score.degraded.rival / score.degraded.peak;
  score.degraded.expected_error_px = random.uniform(0.3, 1.5);
  score.p_correct_fix = std::clamp(0.2 + 2.5 * score.degraded.margin, 0.01, 0.99);
  if (score.p_correct_fix < 0.5) score.reasons = {ReasonCode::kVegetation, ReasonCode::kFlat};
  return score;
}

// Cut from the overview, as read_tile_pictures cuts them from the imagery.
TilePictures pictures_of(const ReportInput& input) {
  TilePictures pictures;
  pictures.side_px = 32;
  pictures.columns = 64;
  const int rows = static_cast<int>(input.mission.ground.tiles.size()) / pictures.columns + 1;
  pictures.sheet = cv::Mat(rows * pictures.side_px, pictures.columns * pictures.side_px, CV_8UC3, cv::Scalar::all(192));
  const cv::Rect all({0, 0}, input.imagery.pixels.size());
  for (std::size_t i = 0; i < input.mission.ground.tiles.size(); ++i) {
    const Bounds& bounds = input.mission.ground.tiles[i].bounds;
    const Eigen::Vector2d a = input.imagery.map_from_pixel.pixel_from_map({bounds.min_x_m, bounds.max_y_m});
    const Eigen::Vector2d b = input.imagery.map_from_pixel.pixel_from_map({bounds.max_x_m, bounds.min_y_m});
    const cv::Rect window = cv::Rect(cv::Point(static_cast<int>(a.x()), static_cast<int>(a.y())),
                                     cv::Point(static_cast<int>(b.x()), static_cast<int>(b.y()))) &
                            all;
    if (window.empty()) continue;
    cv::resize(input.imagery.pixels(window), pictures.sheet(pictures.place(i)),
               cv::Size(pictures.side_px, pictures.side_px), 0, 0, cv::INTER_AREA);
  }
  return pictures;
}

void add_level(const ReportSceneOptions& options, int level, ReportInput& input) {
  GridLevel plan_level;
  plan_level.matrix = matrix_of(options);
  plan_level.matrix.level = level;
  plan_level.gsd_m = kGsd_m * (level + 1);
  if (level == 1) {
    plan_level.matrix.map_from_pixel = GeoTransform::north_up(1000, 9000, plan_level.gsd_m);
    plan_level.matrix.grid_width_px /= 2;
    plan_level.matrix.grid_height_px /= 2;
  }
  plan_level.min_agl_m = level == 0 ? 80 : 160;
  plan_level.max_agl_m = level == 0 ? 160 : 320;
  plan_level.search_radius_px = 128;
  const TileMatrix& matrix = plan_level.matrix;
  for (std::int64_t row = 0; row < matrix.matrix_height(); ++row) {
    for (std::int64_t column = 0; column < matrix.matrix_width(); ++column) {
      GroundTile tile;
      tile.tile_id = static_cast<std::int64_t>(input.mission.ground.tiles.size());
      tile.level = level;
      tile.column = column;
      tile.row = row;
      const PixelWindow window = matrix.tile_window(column, row);
      const Eigen::Vector2d top_left = matrix.map_from_pixel.map_from_pixel(Eigen::Vector2d(window.col, window.row));
      tile.bounds = {top_left.x(), top_left.y() - kTile_px * plan_level.gsd_m,
                     top_left.x() + kTile_px * plan_level.gsd_m, top_left.y()};
      tile.center = input.geodetic_from_map(tile.bounds.center_m());
      tile.valid_fraction = column < 1 && row * 9 < matrix.matrix_height() ? 0.3 : 1;
      input.mission.ground.tiles.push_back(tile);
      input.mission.flight.places.push_back(
          {static_cast<double>(row) * kStride_px * plan_level.gsd_m,
           std::abs(static_cast<double>(column) - options.tiles_across / 2) * kStride_m});
    }
  }
  input.mission.ground.levels.push_back(plan_level);
}

void add_route(const ReportSceneOptions& options, ReportInput& input) {
  const TileMatrix matrix = matrix_of(options);
  const double length_m = (options.tiles_along - 1) * kStride_m;
  const double x_m = 1000 + static_cast<double>(matrix.grid_width_px) * kGsd_m / 2;
  const double start_y_m = 9000 - kTile_px * kGsd_m / 2;
  Route& route = input.mission.flight.route;
  route.name = "valley.plan";
  route.format = "QGroundControl plan";
  for (int i = 0; i <= 4; ++i) {
    RouteVertex vertex;
    vertex.point = input.geodetic_from_map({x_m, start_y_m - length_m * i / 4});
    vertex.kind = "waypoint";
    route.vertices.push_back(vertex);
    if (i > 0) route.legs.push_back({i - 1, i, length_m / 4});
  }
  route.notes = {"Item 3 (camera trigger) is not flown to."};
  const double gap_from_m = options.matchable_from * length_m;
  const double gap_to_m = options.matchable_to * length_m;
  Selection& selection = input.selection;
  selection.max_error_m = options.limit_m;
  for (int i = 0; i < 4; ++i) selection.legs.push_back({i, length_m / 4, 0, 0, true});
  const auto steps = static_cast<int>(length_m / 10);
  int matchable = 0;
  for (int i = 0; i <= steps; ++i) {
    FlightSample sample;
    sample.distance_m = length_m * i / steps;
    sample.leg = std::min(3, static_cast<int>(sample.distance_m / (length_m / 4)));
    sample.point = input.geodetic_from_map({x_m, start_y_m - sample.distance_m});
    sample.agl_m = 120;
    sample.amsl_m = 300 + 60 * std::sin(sample.distance_m / 2000);
    sample.speed_mps = kSpeed_mps;
    input.mission.flight.samples.push_back(sample);
    const bool in_gap = sample.distance_m >= gap_from_m && sample.distance_m < gap_to_m;
    const double error_m =
        in_gap ? 3 + options.drift * (sample.distance_m - gap_from_m) : 3 + std::fmod(sample.distance_m, 150) / 75;
    selection.error_profile.push_back({sample.distance_m, error_m, !in_gap});
    if (!in_gap) ++matchable;
    LegStatus& leg = selection.legs[static_cast<std::size_t>(sample.leg)];
    leg.max_error_m = std::max(leg.max_error_m, error_m);
    leg.within_limit = leg.max_error_m <= options.limit_m;
    if (!in_gap) leg.matchable_fraction += 4.0 / (steps + 1);
  }
  selection.matchable_fraction = static_cast<double>(matchable) / (steps + 1);
  for (LegStatus& leg : selection.legs) leg.matchable_fraction = std::min(1.0, leg.matchable_fraction);
  if (gap_to_m > gap_from_m) {
    RouteGap gap;
    gap.leg = static_cast<int>(gap_from_m / (length_m / 4));
    gap.from_distance_m = gap_from_m;
    gap.to_distance_m = gap_to_m;
    gap.duration_s = (gap_to_m - gap_from_m) / kSpeed_mps;
    gap.error_m = 3 + options.drift * (gap_to_m - gap_from_m);
    gap.within_limit = gap.error_m <= options.limit_m;
    selection.within_limit = gap.within_limit;
    selection.gaps.push_back(gap);
  }
}

}  // namespace

ReportInput report_scene(const ReportSceneOptions& options) {
  ReportInput input;
  input.title = "Valley at two heights";
  input.software_version = "0.1.0";
  const double turn_rad = options.turn_deg * std::numbers::pi / 180;
  const LocalFrame frame(options.origin);
  input.geodetic_from_map = [frame, turn_rad](Eigen::Vector2d xy) {
    const double east_m = std::cos(turn_rad) * xy.x() + std::sin(turn_rad) * xy.y();
    const double north_m = -std::sin(turn_rad) * xy.x() + std::cos(turn_rad) * xy.y();
    return frame.geodetic_from_enu({east_m, north_m, 0});
  };
  input.mission.ground.crs = local_crs("Local grid");
  input.mission.ground.max_scale_distortion = 2e-4;
  input.mission.flight.corridor_half_width_m = 270;
  input.mission.flight.footprint_width_m = input.mission.flight.footprint_height_m = kTile_px * kGsd_m;
  input.mission.ground.imagery.datasets.push_back({"valley.tif", 0.3, "EPSG:32632", "2024-06-01", 30000, 40000});
  input.mission.warnings = {"The imagery is older than two years."};
  add_level(options, 0, input);
  add_level(options, 1, input);
  add_route(options, input);
  Random random(11);
  for (const GroundTile& tile : input.mission.ground.tiles) {
    input.scores.push_back(score_of(tile, random));
    const TileScores& score = input.scores.back();
    const double share = static_cast<double>(tile.row * (tile.level + 1)) / options.tiles_along;
    const bool in_gap = share >= options.matchable_from && share < options.matchable_to;
    if (score.degraded.margin > 0.05 && !in_gap) input.selection.tile_ids.push_back(tile.tile_id);
  }
  input.selection.estimated_bytes = static_cast<std::int64_t>(input.selection.tile_ids.size()) * 6000;
  input.imagery = draw_ground(matrix_of(options));
  input.pictures = pictures_of(input);
  input.parameters = {{"agl_m", 120}, {"camera", {{"hfov_deg", 73.7}, {"width_px", 4000}}}, {"ins_grade", "tactical"}};
  input.inputs = {{"imagery", "valley.tif", "2024-06-01", "blake2b-256:00112233445566778899aabbccddeeff"},
                  {"route", "valley.plan", "", "blake2b-256:ffeeddccbbaa99887766554433221100"}};
  input.assumptions = {"The mount looks straight down."};
  return input;
}

ReportInput report_scene_with_tries() {
  ReportInput input = report_scene({});
  input.selection.tries = FixTries{2.5, std::nullopt, 0.001};
  for (FlightSample& sample : input.mission.flight.samples) sample.speed_mps = 18;
  return input;
}

Report report_with_gap(double drift) {
  ReportSceneOptions options;
  options.matchable_from = 0.3;
  options.matchable_to = 0.9;
  options.drift = drift;
  return make_report(report_scene(options));
}

}  // namespace pilotage::testing
