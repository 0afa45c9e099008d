#include "cut_flight_frames.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include <opencv2/imgcodecs.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/parallel.h"
#include "pilotage/base/random.h"
#include "pilotage/base/text.h"
#include "pilotage/camera/camera_file.h"
#include "pilotage/camera/projection.h"
#include "pilotage/camera/render_frame.h"
#include "pilotage/flightlog/drifting_priors.h"
#include "pilotage/geo/geodesic.h"
#include "pilotage/geo/local_frame.h"
#include "pilotage/geo/position_covariance.h"
#include "pilotage/raster/elevation.h"
#include "pilotage/raster/gdal_io.h"
#include "pilotage/raster/gray_stretch.h"
#include "pilotage/route/read_route.h"

namespace pilotage {
namespace {

constexpr int kTriesPerFrame = 2000;
constexpr int kProbeScale = 16;    // the probe's pixels are so much larger,
constexpr double kProbeSlack = 8;  // and all of one counts as bad where a part is

/// A place on a route, and the direction of flight there.
struct RoutePlace {
  GeodeticPoint point;
  double azimuth_deg = 0;
};

/// What frames are cut from and with.
struct Setup {
  FlightFrameOptions options;
  std::uint64_t seed = 0;
  std::filesystem::path folder;
  GraySource ground;  // in 8 bits
  std::optional<GraySource> also;
  std::vector<RoutePlace> route;  ///< One for each frame, or none: frames lie anywhere.
  std::vector<FlownPlace> flown;  ///< With priors that drift: one for each frame.
  std::vector<DriftingPrior> drifting;
  Camera camera;
  double agl_m = 0;
};

/// The line of a frame in frames.csv.
struct FrameRow {
  std::string file;
  double time_s = 0;
  GeodeticPoint nadir, center, prior;
  Eigen::Matrix2d prior_covariance_en_m2 = Eigen::Matrix2d::Zero();
  Attitude attitude, told_attitude;
  double agl_m = 0, told_agl_m = 0;
};

Camera make_frame_camera(const FlightFrameOptions& options) {
  if (!options.camera.empty()) {
    const Camera camera = read_camera_file(options.camera);
    return resized_camera(camera, options.width_px.value_or(camera.width_px),
                          options.height_px.value_or(camera.height_px));
  }
  Camera camera{options.width_px.value_or(640), options.height_px.value_or(480)};
  camera.fx_px = camera.width_px / 2.0 / std::tan(options.hfov_deg / 2 * std::numbers::pi / 180);
  camera.fy_px = camera.fx_px;
  camera.cx_px = camera.width_px / 2.0;
  camera.cy_px = camera.height_px / 2.0;
  return camera;
}

double wrapped_deg(double angle_deg) {
  return angle_deg - 360 * std::floor(angle_deg / 360);
}

/// Heading anyhow; tilted in any direction by up to the limit, uniformly over the disc.
Attitude random_attitude(Random& random, double max_tilt_deg) {
  const double yaw_deg = random.uniform(0, 360);
  const double tilt_deg = max_tilt_deg * std::sqrt(random.uniform());
  const double direction = random.uniform(0, 2 * std::numbers::pi);
  return {yaw_deg, tilt_deg * std::cos(direction), tilt_deg * std::sin(direction)};
}

/// `count` places along the legs: the middles of as many equal parts of the length.
std::vector<RoutePlace> places_along(const Route& route, int count) {
  const double part_m = route_length_m(route) / count;
  std::vector<RoutePlace> places;
  double flown_m = 0;
  for (const RouteLeg& leg : route.legs) {
    const GeodeticPoint from = route.vertices[static_cast<std::size_t>(leg.from)].point;
    const GeodeticPoint to = route.vertices[static_cast<std::size_t>(leg.to)].point;
    const GeodesicLeg geodesic = geodesic_between(from, to);
    for (;;) {
      const double distance_m = (static_cast<double>(places.size()) + 0.5) * part_m - flown_m;
      if (distance_m >= leg.length_m || places.size() == static_cast<std::size_t>(count)) break;
      const GeodeticPoint point = geodesic_direct(from, geodesic.start_azimuth_deg, distance_m);
      places.push_back({point, geodesic_between(point, to).start_azimuth_deg});
    }
    flown_m += leg.length_m;
  }
  if (places.size() != static_cast<std::size_t>(count)) throw DataError(route.name + ": has no length");
  return places;
}

/// Where the place of a route lies in the imagery, in its pixels.
Eigen::Vector2d route_nadir_px(const Setup& setup, const GeodeticPoint& point) {
  const auto on_map = CrsTransform(setup.ground.crs).map_from_geodetic(point);
  if (!on_map) throw DataError("the route leaves what the imagery's CRS can show");
  return setup.ground.map_from_pixel.pixel_from_map(*on_map);
}

Eigen::Vector2d random_nadir_px(Random& random, const Setup& setup) {
  const auto& region = setup.options.region;
  const GraySource& ground = setup.ground;
  const double across = random.uniform();
  const double down = random.uniform();
  if (region.empty()) {
    return {across * static_cast<double>(ground.width_px), down * static_cast<double>(ground.height_px)};
  }
  return ground.map_from_pixel.pixel_from_map(
      {region[0] + across * (region[2] - region[0]), region[1] + down * (region[3] - region[1])});
}

/// What the prior is off by to the east and to the north.
Eigen::Vector2d prior_error_m(Random& random, const Setup& setup, std::size_t index) {
  const FlightFrameOptions& options = setup.options;
  if (options.prior_drifts) {
    const double direction = Random(setup.seed).uniform(0, 2 * std::numbers::pi);
    return setup.drifting[index].error_en_m +
           options.prior_shift_m * Eigen::Vector2d(std::cos(direction), std::sin(direction));
  }
  const double east_m = random.uniform(-options.prior_offset_m, options.prior_offset_m);
  const double north_m = random.uniform(-options.prior_offset_m, options.prior_offset_m);
  const double direction = random.uniform(0, 2 * std::numbers::pi);
  return {east_m + options.prior_shift_m * std::cos(direction), north_m + options.prior_shift_m * std::sin(direction)};
}

/// Truth and belief of a frame whose truth is `row`'s attitude and height at `place`; without `terrain` over level
/// ground.
void fill_positions(Random& random, const Setup& setup, const GroundPlace& place,
                    const std::optional<TerrainHeights>& terrain, std::size_t index, FrameRow& row) {
  const FlightFrameOptions& options = setup.options;
  const CrsTransform transform(setup.ground.crs);
  const GeoTransform& map_from_pixel = setup.ground.map_from_pixel;
  row.nadir = geodetic_from_pixel(transform, map_from_pixel, place.nadir_px);
  const auto view = make_view(setup.camera, row.attitude, row.agl_m);
  const Eigen::Vector2d principal_px(setup.camera.cx_px, setup.camera.cy_px);
  const auto center_m =
      terrain ? terrain_from_pixel(*view, *terrain, principal_px) : ground_from_pixel(*view, principal_px);
  if (!center_m) throw DataError("the principal point shows no ground");
  row.center = geodetic_from_pixel(transform, map_from_pixel, place.pixel_from_ground(*center_m));
  const Eigen::Vector2d off_m = prior_error_m(random, setup, index);
  row.prior = LocalFrame(row.nadir).geodetic_from_enu({off_m.x(), off_m.y(), 0});
  row.prior_covariance_en_m2 =
      options.prior_drifts ? setup.drifting[index].covariance_en_m2 : isotropic_covariance_m2(options.prior_sigma_m);
  row.time_s = options.prior_drifts ? setup.flown[index].time_s : static_cast<double>(index);
  row.told_attitude = row.attitude;
  for (double* angle_deg : {&row.told_attitude.yaw_deg, &row.told_attitude.pitch_deg, &row.told_attitude.roll_deg}) {
    *angle_deg += options.attitude_sigma_deg * random.normal();
  }
  row.told_attitude.yaw_deg = wrapped_deg(row.told_attitude.yaw_deg);
  row.told_agl_m = row.agl_m * std::max(0.01, 1 + options.height_sigma * random.normal());
}

std::string frame_name(std::size_t index, FrameFormat format) {
  const std::string number = std::to_string(index);
  std::string name = "frame_" + std::string(6 - std::min<std::size_t>(6, number.size()), '0') + number + ".";
  for (const auto& [value, text] : enum_names(FrameFormat{})) {
    if (value == format) name += text;
  }
  return name;
}

/// Whether a small picture of the same view is ground all over.
bool shows_ground(const GraySource& ground, const GroundPlace& place, const Setup& setup, const Attitude& attitude) {
  if (!footprint_inside(ground, place, setup.camera, attitude, setup.agl_m)) return false;
  const Camera small = resized_camera(setup.camera, std::max(1, setup.camera.width_px / kProbeScale),
                                      std::max(1, setup.camera.height_px / kProbeScale));
  const RenderedFrame probe = render_frame(ground, place, small, attitude, setup.agl_m);
  return probe.valid_fraction >= 1 - kProbeSlack * (1 - setup.options.min_valid);
}

bool also_shows_ground(const Setup& setup, const GroundPlace& place, const Attitude& attitude) {
  if (!setup.also) return true;
  const GraySource& also = *setup.also;
  const GeodeticPoint nadir =
      geodetic_from_pixel(CrsTransform(setup.ground.crs), setup.ground.map_from_pixel, place.nadir_px);
  const auto point = CrsTransform(setup.also->crs).map_from_geodetic(nadir);
  if (!point) return false;
  const Eigen::Vector2d nadir_px = also.map_from_pixel.pixel_from_map(*point);
  return shows_ground(also, ground_place(setup.also->crs, also.map_from_pixel, nadir_px), setup, attitude);
}

std::optional<TerrainHeights> terrain_below(const Setup& setup, const GroundPlace& place, const Attitude& attitude,
                                            const Elevation* elevation) {
  if (elevation == nullptr) return std::nullopt;
  const auto view = make_view(setup.camera, attitude, setup.agl_m);
  const GeodeticPoint nadir =
      geodetic_from_pixel(CrsTransform(setup.ground.crs), setup.ground.map_from_pixel, place.nadir_px);
  return terrain_under(*view, nadir, *elevation);
}

/// `elevation`: nullptr over level ground.
FrameRow cut_frame(const Setup& setup, std::size_t index, const Elevation* elevation) {
  Random random(derive_seed(setup.seed, index));
  for (int tried = 0; tried < kTriesPerFrame; ++tried) {
    FrameRow row;
    row.file = frame_name(index, setup.options.format);
    row.attitude = random_attitude(random, setup.options.max_tilt_deg);
    row.agl_m = setup.agl_m;
    if (!setup.route.empty()) row.attitude.yaw_deg = wrapped_deg(setup.route[index].azimuth_deg);
    const Eigen::Vector2d nadir_px =
        setup.route.empty() ? random_nadir_px(random, setup) : route_nadir_px(setup, setup.route[index].point);
    const GraySource& ground = setup.ground;
    const GroundPlace place = ground_place(setup.ground.crs, ground.map_from_pixel, nadir_px);
    if (!shows_ground(ground, place, setup, row.attitude)) continue;
    if (!also_shows_ground(setup, place, row.attitude)) continue;
    const auto terrain = terrain_below(setup, place, row.attitude, elevation);
    const RenderedFrame frame =
        terrain ? render_terrain_frame(ground, place, setup.camera, row.attitude, row.agl_m, *terrain)
                : render_frame(ground, place, setup.camera, row.attitude, row.agl_m);
    if (frame.valid_fraction < setup.options.min_valid) continue;
    fill_positions(random, setup, place, terrain, index, row);
    if (!cv::imwrite((setup.folder / row.file).string(), frame.gray, {cv::IMWRITE_JPEG_QUALITY, 95})) {
      throw DataError((setup.folder / row.file).string() + ": cannot be written");
    }
    return row;
  }
  throw DataError("frame " + std::to_string(index) + ": none of " + std::to_string(kTriesPerFrame) +
                  " places shows imagery all over the frame");
}

std::vector<double> prior_sigmas(const FrameRow& row, bool drifts) {
  const Eigen::Matrix2d& covariance = row.prior_covariance_en_m2;
  if (!drifts) return {std::sqrt(covariance(0, 0))};
  return {std::sqrt(covariance(0, 0)), std::sqrt(covariance(1, 1)), covariance(0, 1)};
}

std::string csv_text(const std::vector<FrameRow>& rows, bool drifts) {
  std::string text = std::string("file,time_s,prior_lon_deg,prior_lat_deg,") +
                     (drifts ? "prior_east_sigma_m,prior_north_sigma_m,prior_covariance_en_m2" : "prior_sigma_m") +
                     ",height_agl_m,yaw_deg,pitch_deg,roll_deg,true_lon_deg,"
                     "true_lat_deg,true_nadir_lon_deg,true_nadir_lat_deg,true_yaw_deg,true_height_agl_m,true_pitch_deg,"
                     "true_roll_deg\n";
  for (const FrameRow& row : rows) {
    text += row.file;
    std::vector<double> numbers{row.time_s, row.prior.lon_deg, row.prior.lat_deg};
    for (const double number : prior_sigmas(row, drifts)) numbers.push_back(number);
    for (const double number :
         {row.told_agl_m, row.told_attitude.yaw_deg, row.told_attitude.pitch_deg, row.told_attitude.roll_deg,
          row.center.lon_deg, row.center.lat_deg, row.nadir.lon_deg, row.nadir.lat_deg, row.attitude.yaw_deg, row.agl_m,
          row.attitude.pitch_deg, row.attitude.roll_deg}) {
      numbers.push_back(number);
    }
    for (const double number : numbers) text += "," + format_number(number);
    text += "\n";
  }
  return text;
}

/// The camera in the dialect of ROS, whose first pixel centre is (0, 0).
std::string camera_yaml(const Camera& camera) {
  const auto matrix = [](const std::string& name, int cols, const std::vector<double>& values) {
    std::vector<std::string> texts;
    for (const double value : values) texts.push_back(format_number(value));
    return name + ":\n  rows: " + std::to_string(values.size() / static_cast<std::size_t>(cols)) +
           "\n  cols: " + std::to_string(cols) + "\n  data: [" + join(texts, ", ") + "]\n";
  };
  const bool fisheye = camera.distortion_model == DistortionModel::kFisheye;
  const auto& d = camera.distortion;
  return "image_width: " + std::to_string(camera.width_px) + "\nimage_height: " + std::to_string(camera.height_px) +
         "\ncamera_name: cut_flight_frames\n" +
         matrix("camera_matrix", 3,
                {camera.fx_px, 0, camera.cx_px - 0.5, 0, camera.fy_px, camera.cy_px - 0.5, 0, 0, 1}) +
         "distortion_model: " + (fisheye ? "equidistant" : "plumb_bob") + "\n" +
         (fisheye ? matrix("distortion_coefficients", 4, {d[0], d[1], d[2], d[3]})
                  : matrix("distortion_coefficients", 5, {d[0], d[1], d[2], d[3], d[4]}));
}

/// Places at equal distances, so at equal times.
void add_drift(Setup& setup, double length_m) {
  const FlightFrameOptions& options = setup.options;
  const double interval_s = length_m / options.frames / options.speed_mps;
  for (const RoutePlace& place : setup.route) {
    setup.flown.push_back({static_cast<double>(setup.flown.size()) * interval_s, place.azimuth_deg});
  }
  setup.drifting = drifting_priors(setup.flown, options.speed_mps, make_ins_error_model(options.ins), setup.seed);
}

Setup make_setup(const std::string& imagery, const std::filesystem::path& folder, const FlightFrameOptions& options,
                 std::uint64_t seed) {
  if (!options.region.empty() && options.region.size() != 4) throw UsageError("--region needs four numbers");
  if (!options.region.empty() && !options.route.empty()) throw UsageError("give --region or --route, not both");
  refuse_imagery_as_elevation(options.elevation, {imagery});
  Setup setup;
  setup.options = options;
  setup.seed = seed;
  setup.folder = folder;
  setup.ground = stretch_to_8bit(open_gray(imagery, options.imagery));
  if (!options.also.empty()) setup.also = stretch_to_8bit(open_gray(options.also, {}));
  if (options.prior_drifts && options.route.empty()) throw UsageError("--prior-drifts needs --route");
  if (!options.route.empty()) {
    const Route route = read_route(options.route);
    setup.route = places_along(route, options.frames);
    if (options.prior_drifts) add_drift(setup, route_length_m(route));
  }
  setup.camera = make_frame_camera(options);
  const Footprint at_1_m = footprint(setup.camera, {}, 1);
  if (!(at_1_m.across_m > 0)) throw UsageError("the camera sees no ground straight down");
  setup.agl_m = options.footprint_m / at_1_m.across_m;
  return setup;
}

}  // namespace

double cut_flight_frames(const std::string& imagery, const std::filesystem::path& folder,
                         const FlightFrameOptions& options, std::uint64_t seed, int threads, bool overwrite) {
  const Setup setup = make_setup(imagery, folder, options, seed);
  std::filesystem::create_directories(folder);
  OutputFile table(folder / "frames.csv", overwrite);
  std::vector<FrameRow> rows(static_cast<std::size_t>(options.frames));
  std::vector<std::unique_ptr<Elevation>> elevations(static_cast<std::size_t>(thread_count(threads)));  // one a thread
  parallel_for(rows.size(), threads, [&](std::size_t index, int worker) {
    std::unique_ptr<Elevation>& own = elevations[static_cast<std::size_t>(worker)];
    if (!own && !options.elevation.empty()) own = std::make_unique<Elevation>(options.elevation);
    rows[index] = cut_frame(setup, index, own.get());
  });
  write_file(folder / "camera.yaml", camera_yaml(setup.camera), overwrite);
  table.write(csv_text(rows, options.prior_drifts));
  table.commit();
  return setup.agl_m;
}

}  // namespace pilotage
