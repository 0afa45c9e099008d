#include "pilotage/simulate/rendered_fixes.h"

#include <functional>
#include <vector>

#include "testing/temporary_folder.h"
#include "testing/textured_map.h"
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"
#include "pilotage/simulate/degraded_frame.h"
#include "pilotage/simulate/fix_log.h"

namespace pilotage {
namespace {

/// A mission of one place, over the middle of textured ground of which there is a map.
struct PlaceWithMap {
  testing::TemporaryFolder folder;
  testing::TexturedGround ground = testing::make_textured_ground(5);
  RenderedWorld world;
  Mission mission;
  SimulateOptions simulate;
  RenderedOptions options;

  PlaceWithMap() {
    testing::write_textured_map(folder / "map.gpkg", ground);
    world.ground = ground.gray;
    world.ground.crs = ground.crs;
    world.of_the_map = false;
    FlightSample sample;
    sample.point = ground.center;
    sample.agl_m = ground.agl_m;
    mission.flight.samples = {sample};
    mission.flight.camera = ground.camera;
    simulate.flights = 2;
    simulate.dropped_frames = 0;
  }

  RenderedFixes fixes(int threads = 2) const {
    return RenderedFixes(mission, simulate, options, rendered_frames(world, ground.camera),
                         open_unverified_maps({folder / "map.gpkg"}), threads);
  }
};

/// A filter that believes to be 6 m too far east and 4 m too far south of where it is.
DrawnErrors off_by_six() {
  DrawnErrors drawn;
  drawn.errors.head<2>() << 6, -4;
  drawn.believed.covariance.topLeftCorner<2, 2>() = 25 * Eigen::Matrix2d::Identity();
  return drawn;
}

FixTry try_with(const DrawnErrors& drawn) {
  FixTry tried;
  tried.off_line_m = {3, 5};
  tried.over_ground_mps = {12, 9};
  tried.heading_deg = -20;
  tried.drawn = &drawn;
  return tried;
}

TEST(RenderedFixes, TheMatcherMeasuresTheFiltersError) {
  const PlaceWithMap place;
  RenderedFixes fixes = place.fixes();
  const DrawnErrors drawn = off_by_six();
  const TriedFix tried = fixes.source().begin_flight(1, 77, 0, {})(try_with(drawn));
  ASSERT_TRUE(tried.has_frame);
  ASSERT_TRUE(tried.fix.has_value());
  EXPECT_TRUE(tried.fix->right);
  EXPECT_LT((tried.fix->innovation_m - Eigen::Vector2d(6, -4)).norm(), 2);
  EXPECT_LT(tried.fix->noise_m2.trace(), 8);
  EXPECT_FALSE(fixes.source().draws_map_error);

  // The same by another thread; another flight has another mount and altimeter.
  const TriedFix again = fixes.source().begin_flight(1, 77, 1, {})(try_with(drawn));
  EXPECT_EQ(again.fix->innovation_m, tried.fix->innovation_m);
  const TriedFix other = fixes.source().begin_flight(0, 78, 1, {})(try_with(drawn));
  EXPECT_NE(other.fix->innovation_m, tried.fix->innovation_m);

  const std::vector<SimulatedTry> tries = fixes.take_tries();
  ASSERT_EQ(tries.size(), 3U);
  EXPECT_EQ(tries[0].flight, 0);
  EXPECT_EQ(tries[1].match.frame.file, "flight_000001/sample_000000");
  EXPECT_LT(tries[1].match.error->error_m, 2);
  EXPECT_NEAR(tries[1].pose.attitude.yaw_deg, 340, 1e-9);
  EXPECT_TRUE(fixes.take_tries().empty());
  const std::string csv = fix_log_to_csv(tries);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 4);
  const std::string header = csv.substr(0, csv.find('\n'));
  const std::string first = csv.substr(header.size() + 1, csv.find('\n', header.size() + 1) - header.size() - 1);
  EXPECT_EQ(std::count(header.begin(), header.end(), ','), std::count(first.begin(), first.end(), ','));
  EXPECT_EQ(header.find("milliseconds"), std::string::npos);
}

TEST(RenderedFixes, AFixFarFromTheTruthIsFalse) {
  PlaceWithMap place;
  place.options.correct_within_m = 1e-3;
  const DrawnErrors drawn = off_by_six();
  const TriedFix tried = place.fixes().source().begin_flight(0, 77, 0, {})(try_with(drawn));
  ASSERT_TRUE(tried.fix.has_value());
  EXPECT_FALSE(tried.fix->right);
}

TEST(RenderedFixes, WithoutAFrameThereIsNoTry) {
  PlaceWithMap place;
  const DrawnErrors drawn = off_by_six();
  FixTry beyond = try_with(drawn);
  beyond.off_line_m = {400, 0};  // the imagery ends
  RenderedFixes fixes = place.fixes();
  EXPECT_FALSE(fixes.source().begin_flight(0, 77, 0, {})(beyond).has_frame);
  place.simulate.dropped_frames = 1;
  EXPECT_FALSE(fixes.source().begin_flight(0, 77, 0, {})(try_with(drawn)).has_frame);
  EXPECT_TRUE(fixes.take_tries().empty());
}

TEST(RenderedFixes, ADeadlineIsRefused) {
  PlaceWithMap place;
  place.options.match.deadline_ms = 100;
  EXPECT_THROW(place.fixes(), UsageError);
}

/// Where the aircraft truly is in a try over ground of these heights above sea level.
CameraPose pose_over(const PlaceWithMap& place, const std::function<double(GeodeticPoint)>& ground_amsl_m) {
  FrameSource frames = rendered_frames(place.world, place.ground.camera);
  frames.open = [open = frames.open, ground_amsl_m] {
    FrameTaker taker = open();
    taker.ground_amsl_m = ground_amsl_m;
    return taker;
  };
  RenderedFixes fixes(place.mission, place.simulate, place.options, frames,
                      open_unverified_maps({place.folder / "map.gpkg"}), 1);
  const DrawnErrors drawn = off_by_six();
  fixes.source().begin_flight(0, 77, 0, {})(try_with(drawn));
  const std::vector<SimulatedTry> tries = fixes.take_tries();
  EXPECT_EQ(tries.size(), 1U);
  return tries.at(0).pose;
}

TEST(RenderedFixes, HeightIsHeldOverRisingGround) {
  const PlaceWithMap place;
  const GeodeticPoint center = place.ground.center;
  const CameraPose pose =
      pose_over(place, [center](GeodeticPoint point) { return 100 + (point.lat_deg > center.lat_deg ? 7 : 0); });
  EXPECT_NEAR(pose.height_agl_m, place.ground.agl_m - 7, 1e-9);
  EXPECT_NEAR(pose.height_amsl_m, 100 + place.ground.agl_m, 1e-9);
}

TEST(RenderedFixes, OverOtherHeightsTheLineStaysWhereItWasPlannedAboveSeaLevel) {
  PlaceWithMap place;
  place.mission.flight.samples.front().amsl_m = 250 + place.ground.agl_m;
  place.world.heights_of_the_map = false;
  const CameraPose pose = pose_over(place, [](GeodeticPoint) { return 259.0; });
  EXPECT_NEAR(pose.height_agl_m, place.ground.agl_m - 9, 1e-9);
  EXPECT_NEAR(pose.height_amsl_m, 250 + place.ground.agl_m, 1e-9);
}

TEST(RenderedCamera, IsAsWideAsAskedFor) {
  Mission mission;
  mission.flight.camera = {4000, 2250, 2700, 2700, 2000, 1125};
  EXPECT_EQ(rendered_camera(mission, {}).width_px, 640);
  EXPECT_EQ(rendered_camera(mission, {}).height_px, 360);
  mission.flight.camera = {320, 240, 270, 270, 160, 120};
  EXPECT_EQ(rendered_camera(mission, {}), mission.flight.camera);
}

TEST(FrameDegrader, ChangesGraysAndNotPlaces) {
  const testing::TexturedGround ground = testing::make_textured_ground();
  const cv::Mat frame = testing::frame_over(ground, 0, 0, {}, ground.agl_m).gray;
  cv::Mat untouched = frame.clone();
  FrameDegrader(0, 5).apply(untouched);
  EXPECT_EQ(cv::norm(untouched, frame, cv::NORM_INF), 0);
  cv::Mat changed = frame.clone();
  FrameDegrader(1, 5).apply(changed);
  cv::Mat again = frame.clone();
  FrameDegrader(1, 5).apply(again);
  EXPECT_EQ(changed.size(), frame.size());
  EXPECT_EQ(cv::norm(changed, again, cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(changed, frame, cv::NORM_L1) / static_cast<double>(frame.total()), 3);
  // The best place of the middle of the changed frame in the frame is its own.
  cv::Mat surface;
  cv::matchTemplate(frame, changed(cv::Rect(20, 20, 120, 80)), surface, cv::TM_CCOEFF_NORMED);
  cv::Point best;
  cv::minMaxLoc(surface, nullptr, nullptr, nullptr, &best);
  EXPECT_LE(cv::norm(best - cv::Point(20, 20)), 1);
}

}  // namespace
}  // namespace pilotage
