// Camera frames of a flight that never was, cut from georeferenced imagery, with the truth beside what the aircraft
// believes:
//   cut_flight_frames RASTER -o FOLDER --frames 500 --seed 1 --footprint-m 154
// FOLDER then holds camera.yaml, frames.csv and the frames. Everything about a frame comes from the seed and the
// frame's number. `cut_flight_frames --help` lists the options.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "run_program.h"
#include <opencv2/imgcodecs.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/parallel.h"
#include "pilotage/base/random.h"
#include "pilotage/base/text.h"
#include "pilotage/camera/camera_file.h"
#include "pilotage/camera/projection.h"
#include "pilotage/camera/render_frame.h"
#include "pilotage/geo/local_frame.h"
#include "pilotage/raster/gdal_io.h"
#include "pilotage/raster/gray_stretch.h"

namespace pilotage {
namespace {

constexpr int kTriesPerFrame = 2000;
constexpr int kProbeScale = 16;    // the probe's pixels are so much larger,
constexpr double kProbeSlack = 8;  // and all of one counts as bad where a part is

enum class Format { kJpg, kPng, kPgm };
EnumNames<Format> enum_names(Format) {
  return {{Format::kJpg, "jpg"}, {Format::kPng, "png"}, {Format::kPgm, "pgm"}};
}

struct CutOptions {
  int frames = 500;
  double footprint_m = 154;
  double hfov_deg = 60;
  std::optional<int> width_px;
  std::optional<int> height_px;
  std::string camera;
  double max_tilt_deg = 5;
  double attitude_sigma_deg = 1;
  double height_sigma = 0.03;
  double prior_offset_m = 60;
  double prior_shift_m = 0;
  double prior_sigma_m = 30;
  double min_valid = 0.999;
  std::string also;
  std::vector<double> region;
  Format format = Format::kJpg;
  ImageryOptions imagery;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("frames", self.frames, "How many.", Range{1, 1e6});
    fields.field("footprint_m", self.footprint_m, "Width on the ground of a frame taken straight down.",
                 Range{0.1, 1e5});
    fields.field("hfov_deg", self.hfov_deg, "Horizontal field of view of the ideal camera.", Range{1, 170});
    fields.field("width_px", self.width_px, "Width of a frame: 640, or that of the calibration file.", Range{1, 10000});
    fields.field("height_px", self.height_px, "Height of a frame: 480, or that of the calibration file.",
                 Range{1, 10000});
    fields.path("camera", self.camera, "A calibration file instead of the ideal camera.");
    fields.field("max_tilt_deg", self.max_tilt_deg, "Largest angle of the belly from straight down.", Range{0, 45});
    fields.field("attitude_sigma_deg", self.attitude_sigma_deg,
                 "Standard deviation of the error of yaw, pitch and roll each.", Range{0, 180});
    fields.field("height_sigma", self.height_sigma, "Standard deviation of the height's error, as a share of it.",
                 Range{0, 0.3});
    fields.field("prior_offset_m", self.prior_offset_m,
                 "The prior is off by at most this to the east and to the north, uniformly.", Range{0, 1e5});
    fields.field("prior_shift_m", self.prior_shift_m,
                 "The prior is off by this besides, in any direction: beyond the window nothing may be found.",
                 Range{0, 1e6});
    fields.field("prior_sigma_m", self.prior_sigma_m, "What the prior says of itself.", Range{0.01, 1e5});
    fields.field("min_valid", self.min_valid, "Least share of a frame that shows imagery.", Range{0, 1});
    fields.path("also", self.also,
                "A second raster, the map's: frames are only where it shows ground all over the frame too.");
    fields.field("region", self.region,
                 "min x, min y, max x, max y in the raster's CRS: where the aircraft is. Default: everywhere.");
    fields.field("format", self.format, "Of the frames; jpg has quality 95.");
    fields.group("imagery", self.imagery, "How the raster is read.", FlagPrefix::kNone);
  }
};

/// Georeferenced imagery in 8 bits.
struct Ground {
  GraySource gray;
  Crs crs;
};

/// What frames are cut from and with.
struct Setup {
  CutOptions options;
  std::uint64_t seed = 0;
  std::filesystem::path folder;
  Ground ground;
  std::optional<Ground> also;
  Camera camera;
  double agl_m = 0;
};

/// The line of a frame in frames.csv.
struct FrameRow {
  std::string file;
  GeodeticPoint nadir, center, prior;
  Attitude attitude, told_attitude;
  double agl_m = 0, told_agl_m = 0;
};

Camera make_frame_camera(const CutOptions& options) {
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

/// Heading anyhow; tilted in any direction by up to the limit, uniformly over the disc.
Attitude random_attitude(Random& random, double max_tilt_deg) {
  const double yaw_deg = random.uniform(0, 360);
  const double tilt_deg = max_tilt_deg * std::sqrt(random.uniform());
  const double direction = random.uniform(0, 2 * std::numbers::pi);
  return {yaw_deg, tilt_deg * std::cos(direction), tilt_deg * std::sin(direction)};
}

Eigen::Vector2d random_nadir_px(Random& random, const Setup& setup) {
  const auto& region = setup.options.region;
  const GraySource& ground = setup.ground.gray;
  const double across = random.uniform();
  const double down = random.uniform();
  if (region.empty()) {
    return {across * static_cast<double>(ground.width_px), down * static_cast<double>(ground.height_px)};
  }
  return ground.map_from_pixel.pixel_from_map(
      {region[0] + across * (region[2] - region[0]), region[1] + down * (region[3] - region[1])});
}

/// Truth and belief of a frame whose truth is `row`'s attitude and height at `place`.
void fill_positions(Random& random, const Setup& setup, const GroundPlace& place, FrameRow& row) {
  const CutOptions& options = setup.options;
  const CrsTransform transform(setup.ground.crs);
  const GeoTransform& map_from_pixel = setup.ground.gray.map_from_pixel;
  row.nadir = geodetic_from_pixel(transform, map_from_pixel, place.nadir_px);
  const auto view = make_view(setup.camera, row.attitude, row.agl_m);
  const auto center_m = ground_from_pixel(*view, {setup.camera.cx_px, setup.camera.cy_px});
  if (!center_m) throw DataError("the principal point shows no ground");
  row.center = geodetic_from_pixel(transform, map_from_pixel, place.pixel_from_ground(*center_m));
  const double east_m = random.uniform(-options.prior_offset_m, options.prior_offset_m);
  const double north_m = random.uniform(-options.prior_offset_m, options.prior_offset_m);
  const double direction = random.uniform(0, 2 * std::numbers::pi);
  row.prior = LocalFrame(row.nadir).geodetic_from_enu(
      {east_m + options.prior_shift_m * std::cos(direction), north_m + options.prior_shift_m * std::sin(direction), 0});
  row.told_attitude = row.attitude;
  for (double* angle_deg : {&row.told_attitude.yaw_deg, &row.told_attitude.pitch_deg, &row.told_attitude.roll_deg}) {
    *angle_deg += options.attitude_sigma_deg * random.normal();
  }
  row.told_attitude.yaw_deg -= 360 * std::floor(row.told_attitude.yaw_deg / 360);
  row.told_agl_m = row.agl_m * std::max(0.01, 1 + options.height_sigma * random.normal());
}

std::string frame_name(std::size_t index, Format format) {
  const std::string number = std::to_string(index);
  std::string name = "frame_" + std::string(6 - std::min<std::size_t>(6, number.size()), '0') + number + ".";
  for (const auto& [value, text] : enum_names(Format{})) {
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
  const GraySource& also = setup.also->gray;
  const GeodeticPoint nadir =
      geodetic_from_pixel(CrsTransform(setup.ground.crs), setup.ground.gray.map_from_pixel, place.nadir_px);
  const auto point = CrsTransform(setup.also->crs).map_from_geodetic(nadir);
  if (!point) return false;
  const Eigen::Vector2d nadir_px = also.map_from_pixel.pixel_from_map(*point);
  return shows_ground(also, ground_place(setup.also->crs, also.map_from_pixel, nadir_px), setup, attitude);
}

FrameRow cut_frame(const Setup& setup, std::size_t index) {
  Random random(derive_seed(setup.seed, index));
  for (int tried = 0; tried < kTriesPerFrame; ++tried) {
    FrameRow row;
    row.file = frame_name(index, setup.options.format);
    row.attitude = random_attitude(random, setup.options.max_tilt_deg);
    row.agl_m = setup.agl_m;
    const Eigen::Vector2d nadir_px = random_nadir_px(random, setup);
    const GraySource& ground = setup.ground.gray;
    const GroundPlace place = ground_place(setup.ground.crs, ground.map_from_pixel, nadir_px);
    if (!shows_ground(ground, place, setup, row.attitude)) continue;
    if (!also_shows_ground(setup, place, row.attitude)) continue;
    const RenderedFrame frame = render_frame(ground, place, setup.camera, row.attitude, row.agl_m);
    if (frame.valid_fraction < setup.options.min_valid) continue;
    fill_positions(random, setup, place, row);
    if (!cv::imwrite((setup.folder / row.file).string(), frame.gray, {cv::IMWRITE_JPEG_QUALITY, 95})) {
      throw DataError((setup.folder / row.file).string() + ": cannot be written");
    }
    return row;
  }
  throw DataError("frame " + std::to_string(index) + ": none of " + std::to_string(kTriesPerFrame) +
                  " places shows imagery all over the frame");
}

std::string csv_text(const std::vector<FrameRow>& rows, double prior_sigma_m) {
  std::string text =
      "file,time_s,prior_lon_deg,prior_lat_deg,prior_sigma_m,height_agl_m,yaw_deg,pitch_deg,roll_deg,true_lon_deg,"
      "true_lat_deg,true_nadir_lon_deg,true_nadir_lat_deg,true_yaw_deg,true_height_agl_m,true_pitch_deg,"
      "true_roll_deg\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const FrameRow& row = rows[i];
    text += row.file;
    for (const double number :
         {static_cast<double>(i), row.prior.lon_deg, row.prior.lat_deg, prior_sigma_m, row.told_agl_m,
          row.told_attitude.yaw_deg, row.told_attitude.pitch_deg, row.told_attitude.roll_deg, row.center.lon_deg,
          row.center.lat_deg, row.nadir.lon_deg, row.nadir.lat_deg, row.attitude.yaw_deg, row.agl_m,
          row.attitude.pitch_deg, row.attitude.roll_deg}) {
      text += "," + format_number(number);
    }
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

Ground open_ground(const std::string& dataset, const ImageryOptions& options) {
  return {stretch_to_8bit(open_gray(dataset, options)), inspect_imagery(dataset, options).crs};
}

Setup prepare(const CutOptions& options, const Invocation& invocation) {
  if (!options.region.empty() && options.region.size() != 4) throw UsageError("--region needs four numbers");
  Setup setup;
  setup.options = options;
  setup.seed = invocation.seed;
  setup.folder = invocation.output;
  setup.ground = open_ground(invocation.inputs.front(), options.imagery);
  if (!options.also.empty()) setup.also = open_ground(options.also, {});
  setup.camera = make_frame_camera(options);
  const Footprint at_1_m = footprint(setup.camera, {}, 1);
  if (!(at_1_m.across_m > 0)) throw UsageError("the camera sees no ground straight down");
  setup.agl_m = options.footprint_m / at_1_m.across_m;
  return setup;
}

CommandResult cut_frames(const CutOptions& options, const Invocation& invocation) {
  const Setup setup = prepare(options, invocation);
  std::filesystem::create_directories(setup.folder);
  OutputFile table(setup.folder / "frames.csv", invocation.overwrite);
  std::vector<FrameRow> rows(static_cast<std::size_t>(options.frames));
  parallel_for(rows.size(), invocation.threads, [&](std::size_t index, int) { rows[index] = cut_frame(setup, index); });
  write_file(setup.folder / "camera.yaml", camera_yaml(setup.camera), invocation.overwrite);
  table.write(csv_text(rows, options.prior_sigma_m));
  table.commit();
  CommandResult result;
  result.text = std::to_string(rows.size()) + " frames from " + format_fixed(setup.agl_m, 1) + " m above ground\n";
  result.json = {{"output", invocation.output}, {"frames", rows.size()}, {"agl_m", setup.agl_m}};
  return result;
}

Command make_cut_command() {
  Command command;
  command.word = "cut_flight_frames";
  command.group = CommandGroup::kStudy;
  command.summary = "Cut camera frames with known truth from imagery";
  command.examples = {{"Frames 154 m wide.", "cut_flight_frames ortho.tif -o frames --frames 500 --footprint-m 154"}};
  command.inputs = {.name = "RASTER", .help = "Georeferenced imagery: a GDAL dataset.", .min = 1, .max = 1};
  command.output = {.kind = OutputKind::kFolder, .help = "Folder for camera.yaml, frames.csv and the frames."};
  bind_options<CutOptions>(command, cut_frames);
  return command;
}

}  // namespace
}  // namespace pilotage

int main(int argc, char** argv) {
  std::vector<std::string> arguments{"cut_flight_frames"};
  arguments.insert(arguments.end(), argv + 1, argv + argc);
  return pilotage::run_program({pilotage::make_cut_command()}, arguments, std::cout, std::cerr);
}
