#include "pilotage/capture/capture.h"

#include <cmath>
#include <fstream>
#include <limits>

#include "drawn_flight.h"
#include "testing/error_of.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/file_digest.h"
#include "pilotage/base/read_file.h"
#include "pilotage/base/statistics.h"
#include "pilotage/capture/match_folder.h"
#include "pilotage/capture/match_shard.h"
#include "pilotage/capture/quality_page.h"
#include "pilotage/geo/geodesic.h"
#include "pilotage/raster/gdal_gray.h"
#include "pilotage/raster/map_sigma.h"

namespace pilotage {
namespace {

using pilotage::testing::capture_to;
using pilotage::testing::draw_flight;
using pilotage::testing::DrawnFlight;
using pilotage::testing::DrawnFrame;
using pilotage::testing::error_of;
using pilotage::testing::misplacements_m;
using pilotage::testing::options_of;
using pilotage::testing::TemporaryFolder;
using pilotage::testing::worst_frame_m;
using pilotage::testing::write_control_points;
using pilotage::testing::write_ground;
using pilotage::testing::write_table;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kHill_m = 6;

/// One flight for all tests: drawing it takes most of their time.
struct DrawnOnce {
  TemporaryFolder folder;
  DrawnFlight flight;
};

const DrawnOnce& drawn() {
  static DrawnOnce once;
  if (once.flight.frames.empty()) once.flight = draw_flight(once.folder.path(), kHill_m, 0.3);
  return once;
}

/// The drawn flight as it is, once, by three threads.
const std::pair<std::filesystem::path, CaptureResult>& captured_once() {
  static const std::filesystem::path map = drawn().folder / "map.tif";
  static const std::pair<std::filesystem::path, CaptureResult> once{
      map,
      capture_to(map, write_table(drawn().folder.path(), drawn().flight.frames, true), options_of(drawn().flight), 3)};
  return once;
}

std::string refused(const std::filesystem::path& table, const CaptureOptions& options) {
  const std::filesystem::path map = drawn().folder / "refused.tif";
  std::filesystem::remove(map);  // of a call that was not refused
  std::filesystem::remove(map_sigma_path(map));
  const std::string message = error_of<DataError>([&] { capture_to(map, table, options); });
  EXPECT_FALSE(std::filesystem::exists(map));
  EXPECT_FALSE(std::filesystem::exists(map_sigma_path(map)));
  return message;
}

TEST(Capture, AMapLiesWhereItsGroundIs) {
  const auto& [map, done] = captured_once();
  EXPECT_EQ(done.frames.size(), 20U);
  EXPECT_LT(done.reprojection_rms_px, 0.5);
  EXPECT_NEAR(done.gsd_m, 0.15, 0.01);
  EXPECT_LT(worst_frame_m(drawn().flight, done), 0.6);
  const std::vector<double> misses_m = misplacements_m(drawn().flight, map);
  ASSERT_GT(misses_m.size(), 40U);
  // Pixels of the true ground are 0.25 m: so exact is the comparison.
  EXPECT_LE(quantile(misses_m, 0.5), 0.36);
  EXPECT_LE(quantile(misses_m, 0.95), 3 * 0.25);
}

TEST(Capture, TheMapTellsItsOwnError) {
  const auto& [map, done] = captured_once();
  // Positions are stated to within 0.3 m beside what they miss alike, 5 m: of 20 frames the map cannot be better.
  EXPECT_GT(done.map_sigma_median_m, 5.0);
  EXPECT_LT(done.map_sigma_median_m, 5.2);
  EXPECT_GE(done.map_sigma_p95_m, done.map_sigma_median_m);
  ImageryOptions first_band;
  first_band.bands = {1};
  const GraySource sigma = open_gray({map_sigma_path(map).string()}, first_band);
  const GraySource picture = open_gray({map.string()});
  EXPECT_EQ(sigma.width_px, (picture.width_px + 15) / 16);
  EXPECT_EQ(sigma.height_px, (picture.height_px + 15) / 16);
  EXPECT_EQ(sigma.map_from_pixel.origin_x, picture.map_from_pixel.origin_x);
  EXPECT_EQ(sigma.map_from_pixel.x_per_col, 16 * picture.map_from_pixel.x_per_col);
  const Raster cells = sigma.read({0, 0, static_cast<int>(sigma.width_px), static_cast<int>(sigma.height_px)});
  EXPECT_GT(cv::countNonZero(cells.valid), cells.valid.rows * cells.valid.cols / 2);
  double least_m = 0;
  cv::minMaxLoc(cells.pixels, &least_m, nullptr, nullptr, nullptr, cells.valid);
  EXPECT_GT(least_m, 5.0);
  ImageryOptions third_band;
  third_band.bands = {3};
  const Raster seen = open_gray({map_sigma_path(map).string()}, third_band)
                          .read({0, 0, static_cast<int>(sigma.width_px), static_cast<int>(sigma.height_px)});
  double fewest = 0;
  double most = 0;
  cv::minMaxLoc(seen.pixels, &fewest, &most, nullptr, nullptr, seen.valid);
  EXPECT_EQ(fewest, 1);
  EXPECT_GE(most, 10);  // steps of 22 m under footprints of 72 m by 54 m
  EXPECT_LE(most, 20);
  EXPECT_GT(done.seen_by_three, 0.5);
  EXPECT_GE(done.frames_seen_median, 3);
}

TEST(Capture, ThePageHoldsNamesAndSaysWhatWasMeasured) {
  const auto& [map, once] = captured_once();
  CaptureResult done = once;
  const QualityPageInput input{"a<b>.tif", map.string(), map_sigma_path(map).string()};
  done.frames[0].file = "x<script>&\"y\xff.jpg";
  done.frames[1].rms_px = std::numeric_limits<double>::quiet_NaN();
  const std::string page = quality_page_html(done, input, {{"align", "<i>"}}, "pilotage");
  EXPECT_THAT(page, AllOf(HasSubstr("x&lt;script&gt;&amp;"), HasSubstr("a&lt;b&gt;.tif"), HasSubstr("&lt;i&gt;"),
                          Not(HasSubstr("<script>&")), Not(HasSubstr("\xff"))));
  EXPECT_THAT(page, AllOf(HasSubstr("± 5."), HasSubstr("modelled and not checked"), HasSubstr("– px")));
  done.check_points.resize(2);
  done.check_points[0].name = "<u>";
  done.check_points[1].is_shown = false;
  done.check_rms_m = 17.3;
  done.check_ratio = 3.4;
  const std::string checked = quality_page_html(done, input, {}, "pilotage");
  EXPECT_THAT(checked,
              AllOf(HasSubstr("± 17 m"), HasSubstr("2 check points miss by 17 m"), HasSubstr("which is too good"),
                    HasSubstr("&lt;u&gt;"), HasSubstr("the map shows another one there")));
}

TEST(CaptureThorough, HeadingAndHeightComeFromThePicturesAlone) {
  const auto& [folder, flight] = drawn();
  std::vector<DrawnFrame> frames = flight.frames;
  for (DrawnFrame& frame : frames) frame.height_m += 400;  // above something else
  const auto table = write_table(folder.path(), frames, false);
  const CaptureResult done = capture_to(folder / "alone.tif", table, options_of(flight));
  for (std::size_t i = 0; i < done.frames.size(); ++i) {
    const double turn_deg = done.frames[i].yaw_deg - flight.frames[i].yaw_deg;
    EXPECT_LT(std::abs(std::remainder(turn_deg, 360)), 1.5) << done.frames[i].file;
    EXPECT_NEAR(done.frames[i].pitch_deg, flight.frames[i].pitch_deg, 1.5) << done.frames[i].file;
  }
  EXPECT_LE(quantile(misplacements_m(flight, folder / "alone.tif"), 0.95), 4 * 0.25);
}

TEST(CaptureThorough, TheSameBytesForAnyNumberOfThreads) {
  const auto& [folder, flight] = drawn();
  const auto& [three, done] = captured_once();
  std::filesystem::create_directory(folder / "one");  // the map tells the name of what stands beside it
  const CaptureResult by_one =
      capture_to(folder / "one" / "map.tif", write_table(folder.path(), flight.frames, true), options_of(flight), 1);
  EXPECT_EQ(by_one.reprojection_rms_px, done.reprojection_rms_px);
  EXPECT_EQ(read_file((folder / "one" / "map.tif").string()), read_file(three.string()));
  EXPECT_EQ(read_file((folder / "one" / "map.map_sigma.tif").string()), read_file(map_sigma_path(three).string()));
}

/// How many files of this kind are kept.
int kept(const std::string& folder, const std::string& ending) {
  int count = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    count += entry.path().extension() == ending ? 1 : 0;
  }
  return count;
}

TEST(CaptureThorough, GoesOnFromWhatARunThatWasStoppedOrShardsHaveMatched) {
  const auto& [map, done] = captured_once();
  const std::filesystem::path table = write_table(drawn().folder.path(), drawn().flight.frames, true);
  CaptureOptions options = options_of(drawn().flight);
  options.matches = (drawn().folder / "matches").string();
  std::filesystem::create_directory(drawn().folder / "resumed");
  const std::filesystem::path again = drawn().folder / "resumed" / "map.tif";
  const auto stop_at = [&](std::int64_t pairs) {
    OutputFile output(again, true);
    OutputFile map_sigma(map_sigma_path(again), true);
    std::int64_t seen = 0;
    EXPECT_THROW(capture({table.string()}, options, output, map_sigma, 1,
                         [&](std::string_view what, std::int64_t now, std::int64_t) {
                           if (what == "matching pairs of frames") seen = now;
                           return seen < pairs;
                         }),
                 Interrupted);
  };
  stop_at(40);
  EXPECT_EQ(kept(options.matches, ".features"), 20);
  EXPECT_EQ(kept(options.matches, ".matches"), 40);
  // Two machines share the rest.
  const MatchedShard first = match_shard({table.string()}, options, {1, 2}, 0);
  const MatchedShard second = match_shard({table.string()}, options, {2, 2}, 0);
  EXPECT_EQ(first.pairs + second.pairs, first.pairs_in);
  EXPECT_LE(std::abs(first.pairs - second.pairs), 1);
  EXPECT_EQ(first.in_common + second.in_common, done.pairs);
  EXPECT_EQ(kept(options.matches, ".matches"), first.pairs_in);
  capture_to(again, table, options, 2);
  EXPECT_EQ(read_file(again), read_file(map));
  EXPECT_EQ(read_file(map_sigma_path(again)), read_file(map_sigma_path(map)));
}

TEST(CaptureThorough, TakesFeaturesAndMatchesThatAreKept) {
  const std::filesystem::path table = write_table(drawn().folder.path(), drawn().flight.frames, true);
  CaptureOptions options = options_of(drawn().flight);
  options.matches = (drawn().folder / "kept").string();
  match_shard({table.string()}, options, {1, 1}, 0);
  MatchFolder folder(options.matches);
  const cv::Mat picture = read_rgb8_picture((drawn().folder / drawn().flight.frames[3].file).string());
  const std::string digest =
      bytes_digest(std::to_string(picture.cols) + " x " + std::to_string(picture.rows) + " " +
                   bytes_digest({reinterpret_cast<const char*>(picture.data), picture.total() * picture.elemSize()}));
  auto features = folder.find_features(digest);
  ASSERT_TRUE(features);
  EXPECT_GT(features->pixels.size(), 100U);
  FrameFeatures none;
  folder.keep_features(digest, none);
  EXPECT_THAT(refused(table, options), AllOf(HasSubstr(drawn().flight.frames[3].file), HasSubstr("shows nothing")));
  // Back again, but a damaged file and one that cannot be read: both are made anew, and no frame is blamed.
  folder.keep_features(digest, *features);
  std::filesystem::path spoilt;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(options.matches)) {
    if (entry.path().extension() == ".matches") spoilt = entry.path();
  }
  write_file(spoilt, "cut", true);
  options.leave_out = true;
  const CaptureResult mended = capture_to(drawn().folder / "mended.tif", table, options);
  EXPECT_EQ(mended.frames.size(), 20U);
  EXPECT_THAT(mended.warnings, Contains(HasSubstr("were not used: 1")));
  EXPECT_THAT(capture_to(drawn().folder / "mended.tif", table, options).warnings,
              Not(Contains(HasSubstr("were not used"))));
}

TEST(Capture, AFolderOfMatchesThatCannotBeIsNamed) {
  const std::filesystem::path table = write_table(drawn().folder.path(), drawn().flight.frames, true);
  CaptureOptions options = options_of(drawn().flight);
  EXPECT_THAT(error_of<UsageError>([&] {
                match_shard({table.string()}, options, {1, 2}, 0);
              }),
              HasSubstr("matches is missing"));
  write_file(drawn().folder / "a_file", "", true);
  options.matches = (drawn().folder / "a_file").string();
  EXPECT_THAT(refused(table, options), HasSubstr("a_file"));
  options.matches = (drawn().folder / "never").string();
  EXPECT_THAT(error_of<UsageError>([&] {
                match_shard({table.string()}, options, {1, 1000}, 0);
              }),
              HasSubstr("at most one shard for each pair"));
  options.crs = "EPSG:99999999";
  EXPECT_THAT(error_of<UsageError>([&] { match_shard({table.string()}, options, {1, 2}, 0); }), HasSubstr("99999999"));
}

TEST(CaptureThorough, FramesWhosePositionCannotBeAreNamed) {
  const auto& [folder, flight] = drawn();
  std::vector<DrawnFrame> frames = flight.frames;
  frames[7].stated.lat_deg += 0.009;  // 1 km
  EXPECT_THAT(
      refused(write_table(folder.path(), frames, true), options_of(flight)),
      AllOf(HasSubstr("frame8.png: its position lies 100"), Not(HasSubstr("frame7.png")), HasSubstr("--leave-out")));
  frames = flight.frames;
  std::swap(frames[3].stated, frames[11].stated);
  EXPECT_THAT(refused(write_table(folder.path(), frames, true), options_of(flight)),
              AllOf(HasSubstr("frame4.png: its position lies"), HasSubstr("frame12.png: its position lies"),
                    Not(HasSubstr("frame5.png"))));
  CaptureOptions options = options_of(flight);
  options.leave_out = true;
  const CaptureResult done = capture_to(folder / "swapped.tif", folder / "frames.csv", options);
  EXPECT_EQ(done.left_out.size(), 2U);
  EXPECT_LE(quantile(misplacements_m(flight, folder / "swapped.tif"), 0.95), 4 * 0.25);
}

TEST(CaptureThorough, AWrongHeightBendsNothingAndIsNamed) {
  const auto& [folder, flight] = drawn();
  for (const double height_m : {1000.0, -200.0}) {
    std::vector<DrawnFrame> frames = flight.frames;
    frames[7].height_m = height_m;
    EXPECT_THAT(refused(write_table(folder.path(), frames, true), options_of(flight)),
                AllOf(HasSubstr("frame8.png: its height lies "), Not(HasSubstr("frame9.png"))))
        << height_m;
  }
}

TEST(CaptureThorough, PositionsThatLagComeOutAsAClock) {
  const auto& [folder, flight] = drawn();
  std::vector<DrawnFrame> frames = flight.frames;
  constexpr double kLag_s = 0.4;
  for (DrawnFrame& frame : frames) {  // a frame each 4 s and 22 m; lines are flown to the east and back
    frame.stated = geodesic_direct(frame.stated, frame.yaw_deg > 0 ? 270 : 90, kLag_s * 22 / 4);
  }
  const CaptureResult done =
      capture_to(folder / "lag.tif", write_table(folder.path(), frames, true), options_of(flight));
  EXPECT_NEAR(done.clock_offset_s, kLag_s, 0.1);
  EXPECT_LT(worst_frame_m(drawn().flight, done), 0.8);
}

TEST(CaptureThorough, ACameraThatIsTurnedAgainstItsStatedAttitude) {
  const auto& [folder, flight] = drawn();
  std::vector<DrawnFrame> frames = flight.frames;
  for (DrawnFrame& frame : frames) frame.yaw_deg += 4;
  frames[5].yaw_deg += 90;
  const CaptureResult done =
      capture_to(folder / "turned.tif", write_table(folder.path(), frames, true), options_of(flight));
  EXPECT_NEAR(std::abs(done.boresight_z_deg), 4, 0.7);
  EXPECT_LT(std::abs(std::remainder(done.frames[5].yaw_deg - flight.frames[5].yaw_deg, 360)), 1.5);
  ASSERT_EQ(done.warnings.size(), 1U);
  EXPECT_THAT(done.warnings.front(), HasSubstr("frame6.png: its heading is 90° from what the pictures show"));
}

TEST(CaptureThorough, WhatDoesNotFitTheFramesIsRefused) {
  const auto& [folder, flight] = drawn();
  const auto table = write_table(folder.path(), flight.frames, true);
  CaptureOptions options = options_of(flight);
  options.camera.height_px = 480;
  EXPECT_THAT(refused(table, options), AllOf(HasSubstr("frame1.png"), HasSubstr("480 x 480"), HasSubstr("frame2.png")));
  options = options_of(flight);
  options.gsd_m = 0.5;
  EXPECT_THAT(error_of<UsageError>([&] { capture_to(folder / "coarse.tif", table, options); }),
              HasSubstr("gsd_m = 0.5 is more than twice that of the frames, 0.1"));
  options = options_of(flight);
  options.elevation = captured_once().first.string();
  EXPECT_THAT(error_of<DataError>([&] { capture_to(folder / "draped.tif", table, options); }),
              HasSubstr(captured_once().first.string()));
}

TEST(Capture, FramesThatShowOtherGroundAreNamed) {
  const auto& [folder, flight] = drawn();
  std::vector<DrawnFrame> frames = flight.frames;
  std::ofstream(folder / "cut.png") << read_file((folder / frames[4].file).string()).substr(0, 3000);
  frames[4].file = "cut.png";
  EXPECT_THAT(refused(write_table(folder.path(), frames, true), options_of(flight)), HasSubstr("cut.png"));
  frames.assign({flight.frames[0], flight.frames[1], flight.frames[9], flight.frames[14]});
  EXPECT_THAT(refused(write_table(folder.path(), frames, true), options_of(flight)),
              AllOf(HasSubstr("frame15.png: shows nothing that the other frames show"),
                    HasSubstr("of which the largest has 3 frames")));
  frames.resize(1);
  EXPECT_THAT(refused(write_table(folder.path(), frames, true), options_of(flight)), HasSubstr("needs at least 3"));
  frames.assign(3, flight.frames[0]);
  EXPECT_THAT(refused(write_table(folder.path(), frames, true), options_of(flight)), HasSubstr("at one place"));
}

TEST(CaptureThorough, ControlPointsTellWhatAllPositionsMissAlike) {
  const auto& [folder, flight] = drawn();
  std::vector<DrawnFrame> frames = flight.frames;
  for (DrawnFrame& frame : frames) {
    frame.stated = geodesic_direct(frame.stated, 90, 4);  // 4 m too far east
    frame.height_m += 30;
  }
  const auto table = write_table(folder.path(), frames, true);
  CaptureOptions options = options_of(flight);
  const std::vector<Eigen::Vector2d> points{{-30, -25}, {35, -20}, {0, 3}, {30, 28}};
  options.control_points = write_control_points(folder.path(), flight, points, kHill_m, 0).string();
  const CaptureResult done = capture_to(folder / "controlled.tif", table, options);
  EXPECT_EQ(done.control_points, 4);
  EXPECT_LT(done.control_rms_m, 0.1);
  EXPECT_NEAR(done.bias_east_m, 4, 0.3);
  EXPECT_NEAR(done.bias_north_m, 0, 0.3);
  EXPECT_LT(worst_frame_m(drawn().flight, done), 0.6);
  EXPECT_LE(quantile(misplacements_m(flight, folder / "controlled.tif"), 0.95), 3 * 0.25);
  write_control_points(folder.path(), flight, points, kHill_m, 3);
  EXPECT_THAT(refused(table, options), HasSubstr("control point \"500158"));
}

/// The drawn flight with positions that are all `east_m` too far east.
std::filesystem::path write_moved_table(double east_m) {
  const auto& [folder, flight] = drawn();
  std::vector<DrawnFrame> frames = flight.frames;
  for (DrawnFrame& frame : frames) frame.stated = geodesic_direct(frame.stated, 90, east_m);
  return write_table(folder.path(), frames, true);
}

CaptureOptions options_to_align(const std::filesystem::path& reference) {
  CaptureOptions options = options_of(drawn().flight);
  options.align = reference.string();
  options.registration.gsd_m = 0.3;  // the drawn ground is small
  return options;
}

TEST(CaptureThorough, AMapTiedToAnotherLiesWhereThatOneHasTheGround) {
  const auto& [folder, flight] = drawn();
  const auto table = write_moved_table(4);
  CaptureOptions options = options_to_align(write_ground(folder / "true.tif", flight, 0));
  options.align_sigma_m = 0.2;
  const CaptureResult done = capture_to(folder / "aligned.tif", table, options);
  ASSERT_TRUE(done.alignment);
  EXPECT_GE(done.alignment->ties, 6);
  EXPECT_NEAR(done.alignment->before.median_shift_en_m.x(), 4, 0.6);
  EXPECT_LT(done.alignment->after.median_shift_en_m.norm(), 0.2);
  EXPECT_NEAR(done.bias_east_m, 4, 0.6);
  EXPECT_LT(worst_frame_m(drawn().flight, done), 1);
  EXPECT_LE(quantile(misplacements_m(flight, folder / "aligned.tif"), 0.95), 3 * 0.25);
  EXPECT_GT(done.map_sigma_median_m, 0.2);
  EXPECT_LT(done.map_sigma_median_m, 0.5);
  // Frames are reduced for the first map, by a factor that does not divide them; any number of threads does the same.
  options.registration.gsd_m = 2.2;
  options.registration.ties.template_px = 24;
  options.registration.ties.spacing_px = 8;
  std::filesystem::create_directory(folder / "alone");
  const CaptureResult reduced = capture_to(folder / "alone" / "reduced.tif", table, options, 1);
  EXPECT_LT(reduced.alignment->after.median_shift_en_m.norm(), 0.5);
  EXPECT_LT(reduced.map_sigma_median_m, 1);
  capture_to(folder / "reduced.tif", table, options, 3);
  EXPECT_EQ(read_file((folder / "alone" / "reduced.tif").string()), read_file((folder / "reduced.tif").string()));
  options.registration = options_to_align("").registration;
  // What the other map may miss is said of this one, and the positions count the more, the more that is.
  options.align_sigma_m = 5;
  const CaptureResult doubted = capture_to(folder / "doubted.tif", table, options);
  EXPECT_NEAR(doubted.alignment->after.median_shift_en_m.x(), 2, 0.5);
  EXPECT_NEAR(doubted.map_sigma_median_m, 5 / std::sqrt(2), 0.4);
}

TEST(CaptureThorough, CheckPointsTellHowFarTheMapIsOff) {
  const auto& [folder, flight] = drawn();
  const auto table = write_moved_table(4);
  CaptureOptions options = options_of(flight);
  const std::vector<Eigen::Vector2d> controls{{-30, -25}, {35, -20}, {0, 3}, {30, 28}};
  const std::vector<Eigen::Vector2d> checks{{-20, 15}, {10, -15}, {25, 10}};
  const auto check_list = write_control_points(folder.path(), flight, checks, kHill_m, 0);
  std::filesystem::rename(check_list, folder / "checks.txt");
  options.check_points = (folder / "checks.txt").string();
  const CaptureResult alone = capture_to(folder / "alone_checked.tif", table, options);
  ASSERT_EQ(alone.check_points.size(), 3U);
  EXPECT_NEAR(alone.check_points.front().miss_east_m, 4, 0.6);
  EXPECT_NEAR(alone.check_points.front().miss_north_m, 0, 0.6);
  EXPECT_NEAR(alone.check_rms_m, 4 / std::sqrt(2), 0.5);
  EXPECT_LT(alone.check_ratio, 1);
  EXPECT_GT(alone.check_ratio, 0.3);
  options.position_bias_sigma_m = 0.1;  // which is not true
  EXPECT_THAT(capture_to(folder / "misled.tif", table, options).warnings,
              ElementsAre(HasSubstr("times as far off as the map says of itself")));
  options.control_points = write_control_points(folder.path(), flight, controls, kHill_m, 0).string();
  options.position_bias_sigma_m = 5;
  const CaptureResult controlled = capture_to(folder / "controlled_checked.tif", table, options);
  EXPECT_LT(controlled.check_rms_m, 0.3);
  EXPECT_EQ(controlled.warnings.size(), 0U);
  options.check_points = options.control_points;
  EXPECT_THAT(refused(table, options), HasSubstr("as well: it would check itself"));
}

TEST(CaptureThorough, TheOtherMapSaysItselfHowFarItMayBeOff) {
  const auto& [map, first] = captured_once();
  const CaptureResult done = capture_to(drawn().folder / "second.tif", write_moved_table(0), options_to_align(map), 2);
  ASSERT_TRUE(done.alignment);
  EXPECT_NEAR(done.alignment->reference_sigma_m, first.map_sigma_median_m, 0.1);
  EXPECT_EQ(done.alignment->sigma_source, ReferenceSigma::kSaid);
}

TEST(CaptureThorough, AnotherMapThatDoesNotFitIsRefused) {
  const auto& [folder, flight] = drawn();
  CaptureOptions options = options_to_align(write_ground(folder / "true.tif", flight, 0));
  options.position_bias_sigma_m = 0.5;
  options.align_sigma_m = 0.5;
  EXPECT_THAT(refused(write_moved_table(6), options),
              AllOf(HasSubstr("true.tif: lies "), HasSubstr("--align-sigma-m, --position-bias-sigma-m")));
  options.align = write_ground(folder / "far.tif", flight, 3000).string();
  EXPECT_THAT(refused(write_moved_table(0), options), HasSubstr("far.tif: shows no ground below the frames"));
  std::filesystem::create_directory(folder / "lonely");
  options.align = (folder / "lonely" / "map.tif").string();
  std::filesystem::copy_file(captured_once().first, options.align);  // without its own error
  options.align_sigma_m.reset();
  EXPECT_THAT(refused(write_moved_table(0), options),
              AllOf(HasSubstr("lonely/map.tif: says that its own error stands in "),
                    HasSubstr("which does not exist; put it there")));
  options.registration.gsd_m = 10;
  options.align = write_ground(folder / "true.tif", flight, 0).string();
  EXPECT_THAT(refused(write_moved_table(0), options),
              AllOf(HasSubstr("is too small for the square that is compared, 96 pixels of 10 m"),
                    HasSubstr("--registration-gsd-m")));
  options.registration.gsd_m = 0.3;
  DrawnFlight elsewhere = flight;  // its rectangle holds the frames', its ground does not
  elsewhere.ground.valid = cv::Mat(flight.ground.valid.size(), CV_8U, cv::Scalar(0));
  elsewhere.ground.valid(cv::Rect(0, 0, 40, 40)).setTo(255);
  options.align = write_ground(folder / "corner.tif", elsewhere, 0).string();
  EXPECT_THAT(
      refused(write_moved_table(0), options),
      AllOf(HasSubstr("corner.tif: shows no ground that the map of the frames shows"), Not(HasSubstr("draft"))));
  DrawnFlight other = flight;
  other.ground.pixels = cv::Mat();  // not the flight's own
  cv::flip(flight.ground.pixels, other.ground.pixels, 0);
  options.align = write_ground(folder / "other.tif", other, 0).string();
  EXPECT_THAT(refused(write_moved_table(0), options),
              AllOf(HasSubstr("other.tif: the map of the frames cannot be tied to it: "), HasSubstr("--min-compared")));
  options.align.clear();
  options.align_sigma_m = 1;
  EXPECT_THAT(error_of<UsageError>([&] { capture_to(folder / "none.tif", write_moved_table(0), options); }),
              HasSubstr("align_sigma_m needs align"));
}

TEST(Capture, WithoutACameraItsTagsAreAskedFor) {
  const auto& [folder, flight] = drawn();
  EXPECT_THAT(refused(write_table(folder.path(), flight.frames, true), CaptureOptions{}),
              HasSubstr("frame1.png: its tags do not say what camera took it (no focal length); give --camera"));
}

}  // namespace
}  // namespace pilotage
