// How often a frame is found on chips, and what tells a true place from a false one. Frames of one raster are searched
// on chips of another that shows the same ground on the same grid at another time; frames of further rasters, and
// frames whose prior is far off, show what other ground gives. docs/decisions/chips.md has the results.
//
//   bench_chip_match MAP FRAMES [--footprint-m 154] [--frames 400] [--factor 4]
//                    [--yaw-steps 3] [--scale-steps 3] [--other RASTER]...
//
// Headings are random, tilt up to 5° in pitch and roll; attitude is told with 1° and height with 3 % error (one sigma);
// the prior is uniform in ±60 m, the window ±90 m. An error is that of the point under the picture's centre.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <limits>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/LU>
#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"
#include "pilotage/build_map/build_chips.h"
#include "pilotage/camera/projection.h"
#include "pilotage/camera/render_frame.h"
#include "pilotage/match/chip_search.h"
#include "pilotage/raster/gdal_io.h"
#include "pilotage/raster/gray_stretch.h"
#include "pilotage/vision/direction_field.h"

namespace pilotage {
namespace {

constexpr double kAgl_m = 120;
constexpr double kPrior_m = 60;
constexpr double kWindow_m = 90;
constexpr int kChipSide = 64;  // of one stored chip, in its own pixels

struct Settings {
  std::vector<std::string> rasters;  // map, frames, others
  double footprint_m = 154;
  int frames = 400;
  int factor = 4;
  int yaw_steps = 3;
  int scale_steps = 3;
};

struct Imagery {
  GraySource source;
  Crs crs;
};

Imagery open_imagery(const std::string& dataset) {
  return {stretch_to_8bit(open_gray(dataset)), inspect_imagery(dataset).crs};
}

struct Frame {
  cv::Mat gray;
  Attitude told;
  double told_agl_m = 0;
  Eigen::Vector2d nadir_px;   // in pixels of the map, meaningful when the frame is of the map's ground
  Eigen::Vector2d center_px;  // the point under the picture's centre
  Eigen::Vector2d prior_px;
};

Eigen::Vector2d center_ground_m(const Camera& camera, const Attitude& attitude, double agl_m) {
  const auto view = make_view(camera, attitude, agl_m);
  return view ? ground_from_pixel(*view, {camera.cx_px, camera.cy_px}).value_or(Eigen::Vector2d::Zero())
              : Eigen::Vector2d::Zero();
}

/// Share of a grid of points in the frame whose ground is valid on the map.
double share_on_map(const GroundPlace& place, const Camera& camera, const Attitude& attitude, const cv::Mat& valid) {
  const auto view = make_view(camera, attitude, kAgl_m);
  int inside = 0;
  for (int i = 0; i < 81; ++i) {
    const auto ground = ground_from_pixel(*view, {(i % 9) * camera.width_px / 8.0, (i / 9) * camera.height_px / 8.0});
    if (!ground) continue;
    const Eigen::Vector2d at = place.pixel_from_ground(*ground);
    const cv::Point pixel(static_cast<int>(at.x()), static_cast<int>(at.y()));
    if (cv::Rect({0, 0}, valid.size()).contains(pixel) && valid.at<std::uint8_t>(pixel) != 0) ++inside;
  }
  return inside / 81.0;
}

/// `map_valid` is empty for rasters of other ground.
std::vector<Frame> cut_frames(const Imagery& imagery, const Camera& camera, int count, const cv::Mat& map_valid,
                              Random& random) {
  std::vector<Frame> frames;
  for (int trial = 0; trial < 100 * count && static_cast<int>(frames.size()) < count; ++trial) {
    Frame frame;
    const Attitude truth{random.uniform(0, 360), random.uniform(-5, 5), random.uniform(-5, 5)};
    frame.nadir_px = {random.uniform(0, static_cast<double>(imagery.source.width_px)),
                      random.uniform(0, static_cast<double>(imagery.source.height_px))};
    const GroundPlace place = ground_place(imagery.crs, imagery.source.map_from_pixel, frame.nadir_px);
    frame.told = {truth.yaw_deg + random.normal(), truth.pitch_deg + random.normal(), truth.roll_deg + random.normal()};
    frame.told_agl_m = kAgl_m * (1 + 0.03 * random.normal());
    frame.prior_px =
        place.pixel_from_ground({random.uniform(-kPrior_m, kPrior_m), random.uniform(-kPrior_m, kPrior_m)});
    if (!footprint_inside(imagery.source, place, camera, truth, kAgl_m)) continue;
    if (!map_valid.empty() && share_on_map(place, camera, truth, map_valid) < 0.95) continue;
    const RenderedFrame rendered = render_frame(imagery.source, place, camera, truth, kAgl_m);
    if (rendered.valid_fraction < 0.99) continue;
    frame.gray = rendered.gray;
    frame.center_px = place.pixel_from_ground(center_ground_m(camera, truth, kAgl_m));
    frames.push_back(frame);
  }
  return frames;
}

struct Chips {
  ChipMosaic mosaic;
  double gsd_m = 0;            // of the map's pixel on the ground
  double convergence_deg = 0;  // true north, clockwise from up the columns
  double bits_per_px = 0;
  double bytes = 0;
};

Chips make_chips(const Imagery& map, const Raster& pixels, const Settings& settings) {
  Chips chips;
  const int factor = settings.factor;
  const cv::Rect whole(0, 0, pixels.pixels.cols / factor * factor, pixels.pixels.rows / factor * factor);
  const cv::Size size = whole.size() / factor;
  chips.mosaic = {cv::Mat::zeros(size, CV_8UC1), cv::Mat::zeros(size, CV_8UC1), 0, 0, factor};
  int count = 0;
  for (int row = kDirectionReachPx; row + kDirectionReachPx < size.height; row += kChipSide) {
    for (int col = kDirectionReachPx; col + kDirectionReachPx < size.width; col += kChipSide) {
      const cv::Rect piece = cv::Rect(col, row, kChipSide, kChipSide) &
                             cv::Rect(0, 0, size.width - kDirectionReachPx, size.height - kDirectionReachPx);
      const cv::Rect seen((piece.x - kDirectionReachPx) * factor, (piece.y - kDirectionReachPx) * factor,
                          (piece.width + 2 * kDirectionReachPx) * factor,
                          (piece.height + 2 * kDirectionReachPx) * factor);
      const ChipPicture picture = make_chip_picture(pixels.pixels(seen), pixels.valid(seen), factor);
      if (cv::countNonZero(picture.valid) == 0) continue;
      const MapChip chip = encode_chip(picture, 0, 0, std::int64_t{col} * factor, std::int64_t{row} * factor);
      const ChipPicture back = decode_chip(chip, "map");
      back.steps.copyTo(chips.mosaic.steps(piece));
      back.valid.copyTo(chips.mosaic.valid(piece));
      chips.bytes += static_cast<double>(chip.data.size());
      ++count;
    }
  }
  chips.bits_per_px = 8 * chips.bytes / cv::countNonZero(chips.mosaic.valid);
  chips.bytes /= std::max(1, count);
  const Eigen::Matrix2d jacobian =
      ground_place(map.crs, map.source.map_from_pixel, {whole.width / 2.0, whole.height / 2.0}).pixel_from_enu_m;
  chips.gsd_m = 1 / std::sqrt(std::abs(jacobian.determinant()));
  chips.convergence_deg = std::atan2(jacobian(0, 1), -jacobian(1, 1)) * 180 / std::numbers::pi;
  return chips;
}

struct Outcome {
  double error_m = std::numeric_limits<double>::infinity();
  double ncc = 0;
  double margin = 0;
  double z = 0;  // ncc·√pixels
  double milliseconds = 0;
};

Outcome search(const Frame& frame, const Chips& chips, const Camera& camera, const Settings& settings) {
  RectifyOptions rectify;
  rectify.gsd_m = chips.gsd_m * chips.mosaic.factor;
  Attitude attitude = frame.told;
  attitude.yaw_deg += chips.convergence_deg;
  const RectifiedFrame rectified = ortho_rectify(frame.gray, camera, attitude, frame.told_agl_m, rectify);
  const auto hypotheses = chip_hypotheses(1.5, settings.yaw_steps, 0.04, settings.scale_steps);
  const auto start = std::clock();
  const auto matches =
      search_chips(make_chip_frame(rectified), chips.mosaic, frame.prior_px, kWindow_m / chips.gsd_m, hypotheses);
  Outcome outcome;
  outcome.milliseconds = 1000.0 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  if (matches.empty()) return outcome;
  const ChipMatch& match = matches.front();
  const Eigen::Vector2d ground_m = match.scale * center_ground_m(camera, attitude, frame.told_agl_m);
  const double turn = match.yaw_deg * std::numbers::pi / 180;
  const Eigen::Vector2d arm_px = Eigen::Vector2d(ground_m.x(), -ground_m.y()) / chips.gsd_m;
  const Eigen::Vector2d center_px =
      match.nadir_px + Eigen::Vector2d(std::cos(turn) * arm_px.x() - std::sin(turn) * arm_px.y(),
                                       std::sin(turn) * arm_px.x() + std::cos(turn) * arm_px.y());
  outcome.error_m = (center_px - frame.center_px).norm() * chips.gsd_m;
  outcome.ncc = match.ncc;
  outcome.margin = match.ncc - rival_ncc(matches, match.nadir_px, 0);
  outcome.z = match.ncc * std::sqrt(match.pixels);
  return outcome;
}

double quantile(const std::vector<Outcome>& outcomes, double Outcome::*member, double share) {
  std::vector<double> values;
  for (const Outcome& outcome : outcomes) values.push_back(outcome.*member);
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())))];
}

void print_quantiles(const char* name, const std::vector<Outcome>& outcomes) {
  std::printf("%s (%zu)\n", name, outcomes.size());
  const auto line = [&](const char* what, double Outcome::*member) {
    std::printf("  %-8s", what);
    for (const double share : {0.001, 0.01, 0.05, 0.5, 0.95, 0.99, 0.999}) {
      std::printf(" %8.3f", quantile(outcomes, member, share));
    }
    std::printf("\n");
  };
  std::printf("  quantile    0.001     0.01     0.05      0.5     0.95     0.99    0.999\n");
  line("ncc", &Outcome::ncc);
  line("margin", &Outcome::margin);
  line("ncc·√n", &Outcome::z);
}

void measure(const Settings& settings) {
  const Imagery map = open_imagery(settings.rasters.at(0));
  const Raster pixels =
      map.source.read({0, 0, static_cast<int>(map.source.width_px), static_cast<int>(map.source.height_px)});
  const Chips chips = make_chips(map, pixels, settings);
  Camera camera;
  camera.width_px = 800;
  camera.height_px = 600;
  camera.fx_px = camera.fy_px = camera.width_px * kAgl_m / settings.footprint_m;
  camera.cx_px = 400;
  camera.cy_px = 300;
  Random random(seed_from_name("bench_chip_match"));
  const auto frames = cut_frames(open_imagery(settings.rasters.at(1)), camera, settings.frames, pixels.valid, random);

  std::vector<Outcome> found;
  std::vector<Outcome> missed;
  std::vector<Outcome> elsewhere;
  int within_5m = 0;
  double milliseconds = 0;
  for (const Frame& frame : frames) {
    const Outcome outcome = search(frame, chips, camera, settings);
    within_5m += outcome.error_m <= 5 ? 1 : 0;
    milliseconds += outcome.milliseconds;
    (outcome.error_m <= 8 ? found : missed).push_back(outcome);
  }
  // The same frames where they are not, and frames of other ground.
  const auto anywhere = [&] {
    return Eigen::Vector2d(random.uniform(0.15, 0.85) * pixels.pixels.cols,
                           random.uniform(0.15, 0.85) * pixels.pixels.rows);
  };
  const double far_px = (2 * kWindow_m + settings.footprint_m) / chips.gsd_m;
  std::vector<Frame> wrong;
  for (Frame frame : frames) {
    for (int trial = 0; trial < 100; ++trial) {  // a small map has no place that is far enough
      frame.prior_px = anywhere();
      if ((frame.prior_px - frame.nadir_px).norm() < far_px) continue;
      wrong.push_back(frame);
      break;
    }
  }
  for (std::size_t i = 2; i < settings.rasters.size(); ++i) {
    for (Frame frame : cut_frames(open_imagery(settings.rasters[i]), camera, settings.frames / 2, {}, random)) {
      frame.prior_px = anywhere();
      wrong.push_back(frame);
    }
  }
  for (const Frame& frame : wrong) elsewhere.push_back(search(frame, chips, camera, settings));

  const double count = static_cast<double>(std::max<std::size_t>(1, frames.size()));
  std::printf("chips of %.2f m/px in %.2f bits/px, %.0f bytes for %d × %d px; %zu frames of %.0f m\n",
              chips.gsd_m * settings.factor, chips.bits_per_px, chips.bytes, kChipSide, kChipSide, frames.size(),
              settings.footprint_m);
  std::printf("within 5 m %.1f %%, within 8 m %.1f %%; error of those: median %.2f m, 95 %% %.2f m; %.1f ms a search\n",
              100 * within_5m / count, 100 * static_cast<double>(found.size()) / count,
              quantile(found, &Outcome::error_m, 0.5), quantile(found, &Outcome::error_m, 0.95), milliseconds / count);
  print_quantiles("within 8 m", found);
  print_quantiles("farther off", missed);
  print_quantiles("other ground, and priors that are far off", elsewhere);
}

Settings settings_from(int argc, char** argv) {
  Settings settings;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (!word.starts_with("--")) {
      settings.rasters.emplace_back(word);
      continue;
    }
    if (++i == argc) throw UsageError(std::string(word) + " needs a value");
    const double value = std::atof(argv[i]);
    if (word == "--other") settings.rasters.emplace_back(argv[i]);
    if (word == "--footprint-m") settings.footprint_m = value;
    if (word == "--frames") settings.frames = static_cast<int>(value);
    if (word == "--factor") settings.factor = static_cast<int>(value);
    if (word == "--yaw-steps") settings.yaw_steps = static_cast<int>(value);
    if (word == "--scale-steps") settings.scale_steps = static_cast<int>(value);
  }
  if (settings.rasters.size() < 2) throw UsageError("bench_chip_match MAP FRAMES [options]: see chip_match.cc");
  return settings;
}

}  // namespace
}  // namespace pilotage

int main(int argc, char** argv) {
  try {
    cv::setNumThreads(1);
    pilotage::measure(pilotage::settings_from(argc, argv));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_chip_match: %s\n", error.what());
    return 1;
  }
  return 0;
}
