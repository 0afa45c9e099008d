#include "pilotage/compare/compare.h"

#include <cmath>

#include "compare/texture.h"
#include "testing/pinhole_camera.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"
#include "pilotage/camera/projection.h"
#include "pilotage/camera/render_frame.h"
#include "pilotage/geo/local_frame.h"
#include "pilotage/raster/gdal_io.h"

namespace pilotage {
namespace {

constexpr double kAglM = 130;
constexpr double kGsdM = 0.6;

Raster gray_raster(std::uint64_t seed) {
  Raster raster;
  raster.pixels = testing::texture(640, 600, seed);
  raster.valid = cv::Mat(raster.pixels.size(), CV_8UC1, cv::Scalar(255));
  raster.map_from_pixel = GeoTransform::north_up(500000, 5'000'000, kGsdM);
  return raster;
}

/// A reference on disk and one frame of it, with the truth.
struct OneFrame {
  testing::TemporaryFolder folder;
  std::string reference = folder / "reference.tif";
  FrameRecord record;
  cv::Mat frame;
  Camera lens = testing::pinhole_camera(480, 400, 400);

  explicit OneFrame(const Attitude& attitude, FrameTruth truth = FrameTruth::kCenter) {
    const Raster ground = gray_raster(11);
    Raster rgb = ground;
    cv::cvtColor(ground.pixels, rgb.pixels, cv::COLOR_GRAY2RGB);
    write_rgb8_geotiff(reference, rgb, "EPSG:32633");
    const Crs crs = Crs::from_user_input("EPSG:32633");
    const GroundPlace place = ground_place(crs, ground.map_from_pixel, {330, 290});
    frame = render_frame(gray_source_from(ground), place, lens, attitude, kAglM).gray;

    const GeodeticPoint nadir = geodetic_from_pixel(CrsTransform(crs), ground.map_from_pixel, {330, 290});
    const LocalFrame local(nadir);
    record.file = "frame.png";
    record.prior = local.geodetic_from_enu({25, -18, 0});
    record.prior_covariance_en_m2 = isotropic_covariance_m2(15);
    record.height_agl_m = kAglM;
    record.attitude = attitude;
    const auto view = make_view(lens, attitude, kAglM);
    const Eigen::Vector2d center = *ground_from_pixel(*view, {lens.cx_px, lens.cy_px});
    if (truth == FrameTruth::kNadir) {
      record.true_nadir = nadir;
    } else {
      record.true_center = local.geodetic_from_enu({center.x(), center.y(), 0});
    }
  }

  Comparison run(const CompareOptions& options) const {
    return compare(
        {reference}, {record}, [this](const FrameRecord&) { return frame; }, lens, options);
  }
};

CompareOptions few_features() {
  CompareOptions options;
  options.max_features = 400;
  return options;
}

TEST(Compare, EveryMethodFindsTheFrame) {
  const OneFrame flight({35, 2, -3});
  const Comparison comparison = flight.run(few_features());
  ASSERT_EQ(comparison.frames.size(), 1U);
  const FrameComparison& frame = comparison.frames.front();
  EXPECT_EQ(frame.problem, "");
  EXPECT_TRUE(frame.shows_reference);
  EXPECT_NEAR(comparison.gsd_m, kGsdM, 1e-3);  // on the ellipsoid, a little more than on the grid
  for (std::size_t i = 0; i < comparison.methods.size(); ++i) {
    SCOPED_TRACE(descriptor_method_title(comparison.methods[i]));
    const MethodOutcome& outcome = frame.methods[i];
    EXPECT_TRUE(outcome.correct) << outcome.inliers << " inliers, error " << outcome.error_m;
    EXPECT_LT(outcome.error_m, 0.6);
    EXPECT_NEAR(outcome.scale, 1, 0.01);
    EXPECT_EQ(outcome.best, kBestMatches);
    EXPECT_GE(outcome.best_agreeing, 9);
    EXPECT_GE(outcome.matches_agreeing, outcome.matches / 5);
    EXPECT_GE(outcome.inliers, outcome.candidates / 2);
    EXPECT_GT(outcome.reference_features, outcome.frame_features);
    EXPECT_GT(outcome.total_ms(), 0);
  }
  EXPECT_EQ(comparison.pictures.size(), comparison.methods.size());
}

TEST(Compare, TheNadirMayBeTheTruth) {
  OneFrame flight({200, 4, 1}, FrameTruth::kNadir);
  CompareOptions options = few_features();
  options.methods = {DescriptorMethod::kOrb256};
  options.truth = FrameTruth::kNadir;
  const Comparison comparison = flight.run(options);
  EXPECT_LT(comparison.frames.front().methods.front().error_m, 0.6);
  options.truth = FrameTruth::kCenter;
  EXPECT_LT(flight.run(options).frames.front().methods.front().error_m, 0.6) << "the one point that is known";
  // The centre lies 9 m from it.
  flight.record.true_center = flight.record.true_nadir;
  options.truth = FrameTruth::kCenter;
  EXPECT_NEAR(flight.run(options).frames.front().methods.front().error_m, kAglM * std::tan(4.12 / 180 * M_PI), 0.6);
}

TEST(Compare, RawFramesNeedDescriptorsThatTurn) {
  const OneFrame flight({70, 0, 0});
  CompareOptions options = few_features();
  options.raw = true;
  const Comparison comparison = flight.run(options);
  for (std::size_t i = 0; i < comparison.methods.size(); ++i) {
    SCOPED_TRACE(descriptor_method_title(comparison.methods[i]));
    const MethodOutcome& outcome = comparison.frames.front().methods[i];
    const DescriptorMethod method = comparison.methods[i];
    const bool turns =
        method == DescriptorMethod::kOrb || method == DescriptorMethod::kSift || method == DescriptorMethod::kSurf;
    EXPECT_EQ(outcome.correct, turns);
    if (turns) {
      EXPECT_LT(outcome.error_m, 1);
      EXPECT_NEAR(outcome.scale, 1, 0.02);
    } else {
      EXPECT_FALSE(outcome.accepted);
    }
  }
}

TEST(Compare, NothingIsAcceptedOnOtherGround) {
  OneFrame flight({35, 2, -3});
  cv::resize(testing::texture(300, 250, 99), flight.frame, flight.frame.size());
  CompareOptions options = few_features();
  for (const bool raw : {false, true}) {
    options.raw = raw;
    const Comparison comparison = flight.run(options);
    for (const MethodOutcome& outcome : comparison.frames.front().methods) {
      EXPECT_FALSE(outcome.accepted);
      EXPECT_FALSE(outcome.correct);
    }
  }
}

TEST(Compare, ATruthOutsideTheWindowIsNoCorrectFix) {
  OneFrame flight({0, 0, 0});
  flight.record.true_center->lon_deg += 0.01;
  CompareOptions options = few_features();
  options.methods = {DescriptorMethod::kOrb256};
  const FrameComparison frame = flight.run(options).frames.front();
  EXPECT_FALSE(frame.shows_reference);
  EXPECT_TRUE(frame.methods.front().accepted);
  EXPECT_FALSE(frame.methods.front().correct);
  EXPECT_EQ(frame.methods.front().best_agreeing, 0);
}

TEST(Compare, APriorWithoutImageryFindsNothing) {
  OneFrame flight({0, 0, 0});
  flight.record.prior.lat_deg += 0.05;
  const FrameComparison frame = flight.run(few_features()).frames.front();
  EXPECT_FALSE(frame.shows_reference);
  for (const MethodOutcome& outcome : frame.methods) EXPECT_EQ(outcome.reference_features, 0);
}

TEST(Compare, AFrameOfTheSkyIsAProblemInWords) {
  OneFrame flight({0, 0, 0});
  flight.record.attitude.pitch_deg = 170;
  const FrameComparison frame = flight.run(few_features()).frames.front();
  EXPECT_NE(frame.problem, "");
  EXPECT_EQ(frame.methods.size(), CompareOptions{}.methods.size());
  EXPECT_FALSE(frame.methods.front().accepted);
}

TEST(Compare, TheSameAgainButForTimes) {
  const OneFrame flight({35, 2, -3});
  cv::setNumThreads(2);
  const Comparison one = flight.run(few_features());
  EXPECT_EQ(cv::getNumThreads(), 2);
  cv::setNumThreads(1);
  const Comparison two = flight.run(few_features());
  for (std::size_t i = 0; i < one.methods.size(); ++i) {
    EXPECT_EQ(one.frames[0].methods[i].inliers, two.frames[0].methods[i].inliers);
    EXPECT_EQ(one.frames[0].methods[i].error_m, two.frames[0].methods[i].error_m);
    EXPECT_EQ(one.frames[0].methods[i].matches_agreeing, two.frames[0].methods[i].matches_agreeing);
    EXPECT_EQ(cv::norm(one.pictures[i].bgr, two.pictures[i].bgr, cv::NORM_L1), 0);
  }
}

template <class Error>
void expect_refused(const OneFrame& flight, const CompareOptions& options, const std::string& what) {
  try {
    flight.run(options);
    FAIL() << "not refused: " << what;
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr(what));
  }
}

TEST(Compare, RefusesWhatCannotBeCompared) {
  const OneFrame flight({0, 0, 0});
  CompareOptions options;
  options.methods = {};
  expect_refused<UsageError>(flight, options, "methods");
  options.methods = {DescriptorMethod::kOrb, DescriptorMethod::kOrb};
  expect_refused<UsageError>(flight, options, "duplicate ORB");
  options = {};
  options.picture_frame = 2;
  expect_refused<UsageError>(flight, options, "picture_frame = 2");
  options = {};
  options.gsd_m = 0.002;
  expect_refused<DataError>(flight, options, "frame.png");

  OneFrame other({0, 0, 0});
  other.record.true_center.reset();
  expect_refused<DataError>(other, {}, "true_lon_deg");
  OneFrame cut({0, 0, 0});
  cut.frame = cut.frame.colRange(0, 100).clone();
  expect_refused<DataError>(cut, {}, "100 x 400 px");
}

}  // namespace
}  // namespace pilotage
