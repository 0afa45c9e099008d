#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "drawn_flight.h"
#include "raster/raster_maker.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"
#include "pilotage/base/statistics.h"
#include "pilotage/camera/attitude.h"
#include "pilotage/capture/capture.h"
#include "pilotage/raster/gdal_gray.h"

namespace pilotage {
namespace {

using pilotage::testing::capture_to;
using pilotage::testing::draw_flight;
using pilotage::testing::DrawnFlight;
using pilotage::testing::DrawnFrame;
using pilotage::testing::height_of_ground_m;
using pilotage::testing::make_raster;
using pilotage::testing::misplacements_m;
using pilotage::testing::options_of;
using pilotage::testing::RasterSpec;
using pilotage::testing::TemporaryFolder;
using pilotage::testing::worst_frame_m;
using pilotage::testing::write_table;
using ::testing::HasSubstr;

constexpr double kSteepHill_m = 20;    // a third of the height of flight, slopes up to 17°
constexpr double kGroundAmsl_m = 250;  // of the drawn ground's foot, in the elevation model
constexpr double kTakeOff_m = 30;      // the frames' heights are above something else

struct FlightOverHill {
  TemporaryFolder folder;
  DrawnFlight flight;
  std::string elevation;
};

const FlightOverHill& over_hill() {
  static FlightOverHill once;
  if (once.flight.frames.empty()) {
    once.flight = draw_flight(once.folder.path(), kSteepHill_m, 0.3);
    constexpr double kPost_m = 2;
    const Raster& ground = once.flight.ground;
    const GeoTransform& place = ground.map_from_pixel;
    const Eigen::Vector2d middle = place.map_from_pixel({ground.pixels.cols / 2.0, ground.pixels.rows / 2.0});
    RasterSpec heights;
    heights.width = heights.height = 160;
    heights.type = GDT_Float32;
    const Eigen::Vector2d corner(middle.x() - 160, middle.y() + 160);
    heights.place = GeoTransform::north_up(corner.x(), corner.y(), kPost_m);
    heights.value = [=](int, int col, int row) {
      const Eigen::Vector2d post = corner + Eigen::Vector2d(col + 0.5, -row - 0.5) * kPost_m;
      return kGroundAmsl_m + height_of_ground_m(post - middle, kSteepHill_m);
    };
    once.elevation = make_raster(once.folder / "heights.tif", heights);
  }
  return once;
}

TEST(CaptureGroundThorough, FramesAreLaidOverAnElevationModel) {
  const auto& [folder, flight, elevation] = over_hill();
  std::vector<DrawnFrame> frames = flight.frames;
  for (DrawnFrame& frame : frames) frame.height_m += kTakeOff_m;
  CaptureOptions options = options_of(flight);
  options.elevation = elevation;
  const auto table = write_table(folder.path(), frames, true);
  const CaptureResult done = capture_to(folder / "draped.tif", table, options);
  ASSERT_EQ(done.frames.size(), frames.size());
  EXPECT_LT(worst_frame_m(flight, done), 0.6);
  EXPECT_LT(done.ground_spread_m, 0.3);  // the points lie on it
  EXPECT_THAT(done.ground, HasSubstr("heights.tif"));
  const Raster& ground = flight.ground;
  const Eigen::Vector2d middle_px(ground.pixels.cols / 2.0, ground.pixels.rows / 2.0);
  const Eigen::Vector2d middle = ground.map_from_pixel.map_from_pixel(middle_px);
  const CrsTransform transform(flight.crs);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const Eigen::Vector2d en_m = *transform.map_from_geodetic(flight.frames[i].nadir) - middle;
    EXPECT_NEAR(done.frames[i].agl_m, flight.frames[i].height_m - height_of_ground_m(en_m, kSteepHill_m), 0.6)
        << done.frames[i].file;
  }
  const std::vector<double> misses_m = misplacements_m(flight, folder / "draped.tif");
  ASSERT_GT(misses_m.size(), 40U);
  EXPECT_LE(quantile(misses_m, 0.95), 3 * 0.25);
}

TEST(CaptureGroundThorough, AnElevationModelWithoutHeightsThereIsNamed) {
  const auto& [folder, flight, elevation] = over_hill();
  RasterSpec elsewhere;
  elsewhere.width = elsewhere.height = 20;
  elsewhere.type = GDT_Float32;
  elsewhere.place = GeoTransform::north_up(600000, 5600000, 10);
  elsewhere.value = [](int, int, int) { return kGroundAmsl_m; };
  CaptureOptions options = options_of(flight);
  options.elevation = make_raster(folder / "elsewhere.tif", elsewhere);
  const auto table = write_table(folder.path(), flight.frames, true);
  try {
    capture_to(folder / "none.tif", table, options);
    FAIL() << "it was taken";
  } catch (const DataError& error) {
    EXPECT_THAT(error.what(), HasSubstr("the elevation model has no height where the frames lie"));
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "none.tif"));
}

TEST(CaptureGroundThorough, TheOrderOfFramesDoesNotMatter) {
  const auto& [folder, flight, elevation] = over_hill();
  DrawnFlight mixed = flight;
  Random random(11);
  for (std::size_t i = mixed.frames.size() - 1; i > 0; --i) {
    std::swap(mixed.frames[i], mixed.frames[static_cast<std::size_t>(random.uniform(0, static_cast<double>(i + 1)))]);
  }
  const auto table = write_table(folder.path(), mixed.frames, true);
  const CaptureResult done = capture_to(folder / "mixed.tif", table, options_of(flight));
  EXPECT_LT(worst_frame_m(mixed, done), 0.6);
  EXPECT_LE(quantile(misplacements_m(flight, folder / "mixed.tif"), 0.95), 3 * 0.25);
}

TEST(CaptureGroundThorough, ACameraThatIsMountedAnotherWay) {
  const auto& [folder, flight, elevation] = over_hill();
  CaptureOptions options = options_of(flight);
  options.camera.mount_yaw_deg = 90;
  options.camera.mount_pitch_deg = 15;
  options.camera.mount_roll_deg = -8;
  const Eigen::Matrix3d mounted =
      body_from_camera({options.camera.mount_yaw_deg, options.camera.mount_pitch_deg, options.camera.mount_roll_deg});
  // The same pictures, taken by an aircraft whose attitude makes up for the mount.
  DrawnFlight other = flight;
  for (DrawnFrame& frame : other.frames) {
    const Attitude attitude = attitude_of(ned_from_body({frame.yaw_deg, frame.pitch_deg, frame.roll_deg}) *
                                          body_from_camera({}) * mounted.transpose());
    frame.yaw_deg = attitude.yaw_deg;
    frame.pitch_deg = attitude.pitch_deg;
    frame.roll_deg = attitude.roll_deg;
  }
  const auto table = write_table(folder.path(), other.frames, true);
  const CaptureResult done = capture_to(folder / "mounted.tif", table, options);
  EXPECT_LT(worst_frame_m(flight, done), 0.6);
  for (std::size_t i = 0; i < done.frames.size(); ++i) {
    const Attitude attitude{done.frames[i].yaw_deg, done.frames[i].pitch_deg, done.frames[i].roll_deg};
    const DrawnFrame& truth = other.frames[i];
    const Eigen::Matrix3d turn =
        ned_from_body(attitude).transpose() * ned_from_body({truth.yaw_deg, truth.pitch_deg, truth.roll_deg});
    EXPECT_LT(std::acos(std::clamp((turn.trace() - 1) / 2, -1.0, 1.0)) * 180 / M_PI, 1.5) << truth.file;
  }
  EXPECT_LE(quantile(misplacements_m(flight, folder / "mounted.tif"), 0.95), 3 * 0.25);
}

/// For each colour of the map, how much it varies against the true ground from place to place: the standard deviation
/// of the logarithm of means over patches of 10 m.
std::vector<double> cast_of_map(const DrawnFlight& flight, const std::filesystem::path& map) {
  const Raster& ground = flight.ground;
  const ColorSource source =
      open_colors_on_grid({map.string()}, flight.crs, ground.map_from_pixel, ground.pixels.cols, ground.pixels.rows);
  const Raster made = source.read({0, 0, ground.pixels.cols, ground.pixels.rows});
  constexpr int kPatch = 40;
  std::vector<std::vector<double>> logs(3);
  for (int row = 0; row + kPatch <= made.pixels.rows; row += kPatch) {
    for (int col = 0; col + kPatch <= made.pixels.cols; col += kPatch) {
      const cv::Rect patch(col, row, kPatch, kPatch);
      if (cv::countNonZero(made.valid(patch)) < patch.area()) continue;
      const cv::Scalar colors = cv::mean(made.pixels(patch));
      const double truth = cv::mean(ground.pixels(patch))[0];
      for (int channel = 0; channel < 3; ++channel) logs[channel].push_back(std::log(colors[channel] / truth));
    }
  }
  std::vector<double> spreads;
  for (const std::vector<double>& values : logs) {
    cv::Scalar mean;
    cv::Scalar deviation;
    cv::meanStdDev(values, mean, deviation);
    spreads.push_back(values.size() > 40 ? deviation[0] : NAN);
  }
  return spreads;
}

TEST(CaptureGroundThorough, ColoursOfFramesAreBroughtToEachOther) {
  const auto& [folder, flight, elevation] = over_hill();
  std::vector<DrawnFrame> frames = flight.frames;
  Random random(5);
  const double half_diagonal_px = std::hypot(flight.camera.width_px, flight.camera.height_px) / 2;
  for (DrawnFrame& frame : frames) {
    const cv::Mat gray = cv::imread((folder / frame.file).string(), cv::IMREAD_GRAYSCALE);
    cv::Vec3d gain;
    for (double& value : gain.val) value = random.uniform(0.6, 1.0);
    cv::Mat colors(gray.size(), CV_8UC3);
    for (int row = 0; row < gray.rows; ++row) {
      for (int col = 0; col < gray.cols; ++col) {
        const double r = std::hypot(col + 0.5 - gray.cols / 2.0, row + 0.5 - gray.rows / 2.0) / half_diagonal_px;
        const cv::Vec3d seen = gain * (1 - 0.3 * r * r) * gray.at<std::uint8_t>(row, col);
        colors.at<cv::Vec3b>(row, col) =
            cv::Vec3b(cv::saturate_cast<std::uint8_t>(seen[0]), cv::saturate_cast<std::uint8_t>(seen[1]),
                      cv::saturate_cast<std::uint8_t>(seen[2]));
      }
    }
    frame.file = "colors_" + frame.file;
    cv::imwrite((folder / frame.file).string(), colors);
  }
  const auto table = write_table(folder.path(), frames, true);
  capture_to(folder / "colors.tif", table, options_of(flight));
  // A frame's gain alone varies by 15 %.
  for (const double spread : cast_of_map(flight, folder / "colors.tif")) EXPECT_LT(spread, 0.03);
}

}  // namespace
}  // namespace pilotage
