#include "pilotage/match/match.h"

#include <cmath>
#include <functional>
#include <limits>
#include <new>
#include <thread>

#include "match/shot.h"
#include "testing/temporary_folder.h"
#include "testing/textured_map.h"
#include <Eigen/LU>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/core/utility.hpp>

#include "pilotage/base/nan.h"
#include "pilotage/base/random.h"
#include "pilotage/camera/projection.h"
#include "pilotage/geo/geodesic.h"
#include "pilotage/geo/local_frame.h"

namespace pilotage {
namespace {

using testing::match_shot;
using testing::prior_of;
using testing::Shot;
using testing::ShotAnswer;
using testing::ShotMap;
using testing::TemporaryFolder;
using testing::TexturedGround;

/// A map of texture, made once for all tests.
const ShotMap& textured_map() {
  static const ShotMap kMap(testing::make_textured_ground());
  return kMap;
}

double turn_between_deg(double a_deg, double b_deg) {
  return std::abs(std::remainder(a_deg - b_deg, 360.0));
}

TEST(Match, AKnownPoseIsFound) {
  for (int heading_deg = 0; heading_deg < 360; heading_deg += 60) {
    Shot shot;
    shot.east_m = 7;
    shot.north_m = -11;
    shot.attitude.yaw_deg = heading_deg;
    const ShotAnswer answer = match_shot(textured_map(), shot);
    ASSERT_EQ(answer.result.status, MatchStatus::kFix) << heading_deg;
    const Fix& fix = *answer.result.fix;
    EXPECT_LT(answer.error_m.norm(), 0.7) << heading_deg;
    EXPECT_LT(answer.center_error_m.norm(), 0.3) << heading_deg;
    EXPECT_LT(turn_between_deg(fix.yaw_deg, heading_deg), 0.3);
    EXPECT_NEAR(fix.height_agl_m, 60, 0.6);
    EXPECT_NEAR(fix.scale, 1, 0.01);
    EXPECT_GE(fix.yaw_deg, 0);
    EXPECT_LT(fix.yaw_deg, 360);
    EXPECT_GT(answer.result.stats.inliers, 50);
    EXPECT_GT(answer.result.stats.vote_peak, 2 * answer.result.stats.vote_rival);
    EXPECT_GT(answer.result.stats.expected_features, 50);
    EXPECT_GT(answer.result.stats.support, 50);
    EXPECT_LT(answer.result.stats.residual_m, 0.5);
    EXPECT_EQ(answer.result.stats.level, 0);
    EXPECT_NEAR(answer.result.stats.gsd_m, 0.5, 0.001);
  }
}

TEST(Match, TheMapsOwnErrorIsThatOfTheTileUnlessTheCallerSaysAnother) {
  TexturedGround ground = testing::make_textured_ground();
  ground.map_sigma_m = 4;
  const ShotMap captured(ground);
  MatchOptions given;
  given.map_sigma_m = 2;
  const ShotAnswer silent = match_shot(textured_map(), {});
  const ShotAnswer said = match_shot(captured, {});
  const ShotAnswer told = match_shot(captured, {}, given);
  ASSERT_TRUE(silent.result.fix && said.result.fix && told.result.fix);
  EXPECT_EQ(silent.result.fix->map_sigma_m, kUnknownMapSigma_m);
  EXPECT_EQ(said.result.fix->map_sigma_m, 4);
  EXPECT_EQ(told.result.fix->map_sigma_m, 2);
  const auto variance_m2 = [](const ShotAnswer& answer) { return answer.result.fix->covariance_en_m2(0, 0); };
  EXPECT_NEAR(variance_m2(said) - variance_m2(silent), 16 - 1, 1e-9);
  EXPECT_NEAR(variance_m2(told) - variance_m2(silent), 4 - 1, 1e-9);
}

TEST(Match, ErrorsOfThePriorAreMended) {
  Random random(seed_from_name("errors of the prior"));
  for (int i = 0; i < 12; ++i) {
    Shot shot;
    shot.east_m = random.uniform(-20, 20);
    shot.north_m = random.uniform(-20, 20);
    shot.attitude = {random.uniform(0, 360), random.uniform(-6, 6), random.uniform(-6, 6)};
    shot.prior_off_m = {random.uniform(-20, 20), random.uniform(-20, 20)};
    shot.attitude_off = {random.uniform(-2, 2), random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5)};
    shot.height_m = random.uniform(55, 65);
    shot.height_ratio = random.uniform(0.95, 1.05);
    const ShotAnswer answer = match_shot(textured_map(), shot);
    ASSERT_EQ(answer.result.status, MatchStatus::kFix) << i;
    const Fix& fix = *answer.result.fix;
    EXPECT_LT(answer.error_m.norm(), 1) << i;
    EXPECT_LT(answer.center_error_m.norm(), 0.4) << i;
    EXPECT_LT(turn_between_deg(fix.yaw_deg, shot.attitude.yaw_deg), 0.5) << i;
    EXPECT_NEAR(fix.height_agl_m, shot.height_m, 1) << i;
    EXPECT_NEAR(fix.scale, 1 / shot.height_ratio, 0.02) << i;
    // Two by two, with the map's own 1 m in it: the truth lies well inside.
    EXPECT_LT(answer.error_m.dot(fix.covariance_en_m2.inverse() * answer.error_m), 9) << i;
  }
}

TEST(Match, EachErrorOfTheAttitudeIsMendedWithItsSign) {
  for (const double heading_deg : {0.0, 90.0, 217.0}) {
    for (const double off_deg : {-1.5, 1.5}) {
      for (int axis = 0; axis < 3; ++axis) {
        Shot shot;
        shot.attitude = {heading_deg, 2, -3};
        shot.focal_px = 90;  // wide: tilt shows in the frame's perspective
        if (axis == 0) shot.attitude_off.yaw_deg = off_deg;
        if (axis == 1) shot.attitude_off.pitch_deg = off_deg;
        if (axis == 2) shot.attitude_off.roll_deg = off_deg;
        MatchOptions options;
        options.attitude_sigma_deg = 2;
        options.yaw_sigma_deg = 2;
        const ShotAnswer answer = match_shot(textured_map(), shot, options);
        ASSERT_EQ(answer.result.status, MatchStatus::kFix) << heading_deg << " " << axis;
        const Fix& fix = *answer.result.fix;
        EXPECT_LT(turn_between_deg(fix.yaw_deg, heading_deg), 0.5) << heading_deg << " " << axis;
        EXPECT_NEAR(fix.pitch_deg, 2, 0.5) << heading_deg << " " << axis << " " << off_deg;
        EXPECT_NEAR(fix.roll_deg, -3, 0.5) << heading_deg << " " << axis << " " << off_deg;
        EXPECT_LT(answer.error_m.norm(), 1) << heading_deg << " " << axis << " " << off_deg;
      }
    }
  }
}

TEST(Match, HeightIsMended) {
  for (const double ratio : {0.94, 1.06}) {
    Shot shot;
    shot.attitude.yaw_deg = 33;
    shot.height_ratio = ratio;
    const ShotAnswer answer = match_shot(textured_map(), shot);
    ASSERT_EQ(answer.result.status, MatchStatus::kFix);
    EXPECT_NEAR(answer.result.fix->height_agl_m, 60, 0.6);
    EXPECT_LT(answer.result.fix->height_sigma_m, 1);
  }
}

TEST(Match, TheMountTurnsTheView) {
  for (const CameraMount& mount : {CameraMount{90, 0, 0}, CameraMount{0, 12, 0}, CameraMount{-35, 5, -8}}) {
    Shot shot;
    shot.attitude = {70, 1, 2};
    shot.mount = mount;
    const ShotAnswer answer = match_shot(textured_map(), shot);
    ASSERT_EQ(answer.result.status, MatchStatus::kFix) << mount.pitch_deg;
    EXPECT_LT(answer.error_m.norm(), 1) << mount.pitch_deg;
    EXPECT_LT(answer.center_error_m.norm(), 0.4) << mount.pitch_deg;
  }
}

TEST(Match, TheCenterIsWhereTheCameraLooks) {
  Shot shot;
  shot.attitude = {90, 0, 0};
  shot.mount.pitch_deg = 15;  // looks ahead, to the east
  const ShotAnswer answer = match_shot(textured_map(), shot);
  ASSERT_EQ(answer.result.status, MatchStatus::kFix);
  const Fix& fix = *answer.result.fix;
  const GeodesicLeg leg = geodesic_between(fix.position, fix.center);
  EXPECT_NEAR(leg.length_m, 60 * std::tan(15 * std::acos(-1) / 180), 1.5);
  EXPECT_NEAR(leg.start_azimuth_deg, 90, 5);
  // The attitude's error moves the nadir, not the point in view.
  EXPECT_LT(fix.center_covariance_en_m2.trace(), fix.covariance_en_m2.trace());
}

TEST(MatchThorough, AnyHeadingIsFound) {
  MatchOptions options;
  options.yaw_sigma_deg = 180;
  for (const double heading_deg : {15.0, 140.0, 265.0}) {
    Shot shot;
    shot.attitude = {heading_deg, 2, -1};
    shot.attitude_off.yaw_deg = -heading_deg;  // the prior says north
    const ShotAnswer answer = match_shot(textured_map(), shot, options);
    ASSERT_EQ(answer.result.status, MatchStatus::kFix) << heading_deg;
    EXPECT_LT(answer.error_m.norm(), 1) << heading_deg;
    EXPECT_LT(turn_between_deg(answer.result.fix->yaw_deg, heading_deg), 0.5) << heading_deg;
  }
}

TEST(Match, APriorWrongByMoreThanTheWindowGivesNoFix) {
  for (const Eigen::Vector2d& off : {Eigen::Vector2d(55, 0), Eigen::Vector2d(0, -58), Eigen::Vector2d(-50, 50)}) {
    Shot shot;
    shot.prior_off_m = off;
    const ShotAnswer answer = match_shot(textured_map(), shot);
    EXPECT_NE(answer.result.status, MatchStatus::kFix) << off.transpose();
    EXPECT_FALSE(answer.result.fix);
  }
}

TEST(Match, FramesOfOtherGroundGiveNoFix) {
  const ShotMap& map = textured_map();
  TexturedGround other = map.ground;
  Raster mirrored{{}, {}, map.ground.gray.map_from_pixel};
  const Raster whole = map.ground.gray.read({0, 0, 384, 384});
  cv::flip(whole.pixels, mirrored.pixels, 0);
  mirrored.valid = cv::Mat(mirrored.pixels.size(), CV_8U, cv::Scalar(255));
  other.gray = gray_source_from(mirrored);
  MapReader reader = MapReader::open_unverified(map.path);
  for (int i = 0; i < 8; ++i) {
    Shot shot;
    shot.east_m = 5 * i - 20;
    shot.attitude.yaw_deg = 45.0 * i;
    const cv::Mat frame = testing::frame_over(other, shot.east_m, shot.north_m, shot.attitude, shot.height_m).gray;
    const MatchResult result = match(frame, prior_of(map, shot), other.camera, reader);
    EXPECT_NE(result.status, MatchStatus::kFix) << i;
    EXPECT_FALSE(result.fix);
    EXPECT_LE(result.stats.confidence, 0.999);
  }
}

TEST(Match, BadInputIsAStatus) {
  const ShotMap& map = textured_map();
  MapReader reader = MapReader::open_unverified(map.path);
  const Shot shot;
  const Camera& camera = map.ground.camera;
  const cv::Mat frame = testing::frame_over(map.ground, 0, 0, {}, 60).gray;
  const MatchPrior prior = prior_of(map, shot);
  ASSERT_EQ(match(frame, prior, camera, reader).status, MatchStatus::kFix);
  const auto status = [&](auto change) {
    MatchPrior changed = prior;
    change(changed);
    const MatchResult result = match(frame, changed, camera, reader);
    EXPECT_FALSE(result.fix);
    return result.status;
  };
  EXPECT_EQ(status([](MatchPrior& p) { p.attitude.pitch_deg = kNaN; }), MatchStatus::kBadPrior);
  EXPECT_EQ(status([](MatchPrior& p) { p.attitude.yaw_deg = 1 / 0.0; }), MatchStatus::kBadPrior);
  EXPECT_EQ(status([](MatchPrior& p) { p.height_agl_m = 0; }), MatchStatus::kBadPrior);
  EXPECT_EQ(status([](MatchPrior& p) { p.height_agl_m = -60; }), MatchStatus::kBadPrior);
  EXPECT_EQ(status([](MatchPrior& p) { p.height_agl_m = kNaN; }), MatchStatus::kBadPrior);
  EXPECT_EQ(status([](MatchPrior& p) { p.covariance_en_m2 = isotropic_covariance_m2(0); }), MatchStatus::kBadPrior);
  EXPECT_EQ(status([](MatchPrior& p) { p.covariance_en_m2 = isotropic_covariance_m2(kNaN); }), MatchStatus::kBadPrior);
  EXPECT_EQ(status([](MatchPrior& p) { p.covariance_en_m2 << 1, 2, 2, 1; }), MatchStatus::kBadPrior);
  EXPECT_EQ(status([](MatchPrior& p) { p.covariance_en_m2 << 100, 5, -5, 100; }), MatchStatus::kBadPrior);
  EXPECT_EQ(status([](MatchPrior& p) { p.position.lat_deg = 90.5; }), MatchStatus::kBadPrior);
  EXPECT_EQ(status([](MatchPrior& p) { p.position.lon_deg = kNaN; }), MatchStatus::kBadPrior);
  EXPECT_EQ(status([](MatchPrior& p) { p.position.lat_deg = 90; }), MatchStatus::kNoMap);
  EXPECT_EQ(status([](MatchPrior& p) { p.position.lat_deg = -90; }), MatchStatus::kNoMap);
  EXPECT_EQ(status([](MatchPrior& p) { p.position.lat_deg += 0.1; }), MatchStatus::kNoMap);
  EXPECT_EQ(status([](MatchPrior& p) { p.attitude.pitch_deg = 180; }), MatchStatus::kNoGround);

  const cv::Size size = frame.size();
  for (const auto& [bad, what] :
       {std::pair(cv::Mat(), "empty"), std::pair(cv::Mat(1, 1, CV_8U), "1 x 1"),
        std::pair(cv::Mat(size, CV_8UC3), "colour"), std::pair(cv::Mat(size, CV_16U), "16 bit"),
        std::pair(cv::Mat(size.width, size.height, CV_8U), "turned")}) {
    EXPECT_EQ(match(bad, prior, camera, reader).status, MatchStatus::kBadFrame) << what;
  }
  for (const int gray : {0, 255}) {
    const MatchResult result = match(cv::Mat(size, CV_8U, cv::Scalar(gray)), prior, camera, reader);
    EXPECT_NE(result.status, MatchStatus::kFix) << gray;
    EXPECT_NE(result.status, MatchStatus::kBadFrame) << gray;
  }
  const Camera tiny{1, 1, 1, 1, 0.5, 0.5};
  EXPECT_EQ(match(cv::Mat(1, 1, CV_8U, cv::Scalar(9)), prior, tiny, reader).status, MatchStatus::kNoGround);
  Camera broken = camera;
  broken.fx_px = 0;
  EXPECT_EQ(match(frame, prior, broken, reader).status, MatchStatus::kBadCamera);
  MatchOptions options;
  options.search_sigmas = kNaN;
  EXPECT_EQ(match(frame, prior, camera, reader, options).status, MatchStatus::kBadOptions);
}

TEST(Match, ADeadlineOfNothingIsOutOfTimeBeforeAnything) {
  const ShotMap& map = textured_map();
  MapReader reader = MapReader::open_unverified(map.path);
  const Shot shot;
  const cv::Mat frame = testing::frame_over(map.ground, 0, 0, {}, 60).gray;
  MatchOptions options;
  options.deadline_ms = 0;
  const MatchResult result = match(frame, prior_of(map, shot), map.ground.camera, reader, options);
  EXPECT_EQ(result.status, MatchStatus::kOutOfTime);
  EXPECT_FALSE(result.fix || result.candidate);
  EXPECT_EQ(result.stats.level, -1) << "the map was not looked at";
  EXPECT_EQ(match(cv::Mat(), prior_of(map, shot), map.ground.camera, reader, options).status, MatchStatus::kOutOfTime);
  options.deadline_ms = 1e9;
  EXPECT_EQ(match(frame, prior_of(map, shot), map.ground.camera, reader, options).status, MatchStatus::kFix);
}

TEST(MatchThorough, WhoeverAsksToEndItIsHeardWhereverItIs) {
  const ShotMap& map = textured_map();
  MapReader reader = MapReader::open_unverified(map.path);
  Shot shot;
  MatchPrior prior = prior_of(map, shot);
  prior.covariance_en_m2 = isotropic_covariance_m2(60);
  const cv::Mat frame = testing::frame_over(map.ground, 0, 0, {}, 60).gray;
  int asked = 0;
  const MatchResult whole = match(frame, prior, map.ground.camera, reader, {}, [&] { return ++asked > 0; });
  EXPECT_GT(asked, 40) << "some milliseconds lie between two";
  EXPECT_EQ(whole.status, MatchStatus::kFix);
  for (int end = 1; end <= asked; end += 1 + asked / 25) {
    int count = 0;
    EXPECT_THROW(match(frame, prior, map.ground.camera, reader, {}, [&] { return ++count < end; }), Interrupted);
    EXPECT_EQ(count, end);
  }
  EXPECT_EQ(match(frame, prior, map.ground.camera, reader).status, MatchStatus::kFix)
      << "afterwards it works as before";
}

TEST(Match, LessMemoryThanItIsMeantToTakeIsTooUncertain) {
  const ShotMap& map = textured_map();
  const Shot shot;
  const cv::Mat frame = testing::frame_over(map.ground, 0, 0, {}, 60).gray;
  const auto result = [&](double max_memory_mib) {
    MapReader reader = MapReader::open_unverified(map.path);
    MatchOptions options;
    options.max_memory_mib = max_memory_mib;
    return match(frame, prior_of(map, shot), map.ground.camera, reader, options);
  };
  double enough = 512;
  while (result(enough).status == MatchStatus::kFix) enough /= 1.1;
  enough *= 1.1;
  EXPECT_LT(enough, 64) << "for a frame of 140 px";
  // Whatever step finds that it is not enough, the status is the same, however many threads ask at once.
  for (double mib = enough / 1.1; mib > 0.1; mib /= 1.5) {
    std::vector<MatchStatus> of_thread(4);
    std::vector<std::thread> threads;
    for (MatchStatus& status : of_thread) threads.emplace_back([&] { status = result(mib).status; });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(of_thread, std::vector<MatchStatus>(4, MatchStatus::kTooUncertain)) << mib;
  }
  EXPECT_EQ(result(0).status, MatchStatus::kTooUncertain);
  EXPECT_FALSE(result(0).candidate);
}

/// Memory for matrices that runs out after some of them, as cv::fastMalloc says it; back as it was when it dies.
class ScarceMatrices : public cv::MatAllocator {
 public:
  explicit ScarceMatrices(int left) : left_(left) { cv::Mat::setDefaultAllocator(this); }
  ~ScarceMatrices() override { cv::Mat::setDefaultAllocator(cv::Mat::getStdAllocator()); }
  ScarceMatrices(const ScarceMatrices&) = delete;
  ScarceMatrices& operator=(const ScarceMatrices&) = delete;

  int taken() const { return taken_; }

  cv::UMatData* allocate(int dims, const int* sizes, int type, void* data, size_t* step, cv::AccessFlag flags,
                         cv::UMatUsageFlags usage) const override {
    if (taken_++ >= left_) CV_Error(cv::Error::StsNoMem, "no memory");
    return cv::Mat::getStdAllocator()->allocate(dims, sizes, type, data, step, flags, usage);
  }
  bool allocate(cv::UMatData* data, cv::AccessFlag flags, cv::UMatUsageFlags usage) const override {
    return cv::Mat::getStdAllocator()->allocate(data, flags, usage);
  }
  void deallocate(cv::UMatData* data) const override { cv::Mat::getStdAllocator()->deallocate(data); }

 private:
  int left_;
  mutable int taken_ = 0;
};

TEST(Match, SaysThatMemoryRanOutWhereverItDoes) {
  const ShotMap& map = textured_map();
  const cv::Mat frame = testing::frame_over(map.ground, 0, 0, {}, 60).gray;
  const MatchPrior prior = prior_of(map, {});
  const int opencv_threads = cv::getNumThreads();
  cv::setNumThreads(1);
  const auto matched = [&](const std::function<bool()>& go_on = {}) {
    MapReader reader = MapReader::open_unverified(map.path);
    return match(frame, prior, map.ground.camera, reader, {}, go_on).status;
  };
  int needed = 0;
  {
    const ScarceMatrices plenty(std::numeric_limits<int>::max());
    EXPECT_EQ(matched(), MatchStatus::kFix);
    needed = plenty.taken();
  }
  EXPECT_GT(needed, 20);
  for (int left = 0; left < needed; left += 1 + needed / 40) {
    const ScarceMatrices scarce(left);
    EXPECT_EQ(matched(), MatchStatus::kOutOfMemory) << left << " of " << needed;
  }
  EXPECT_EQ(matched([]() -> bool { throw std::bad_alloc(); }), MatchStatus::kOutOfMemory);
  EXPECT_EQ(matched(), MatchStatus::kFix) << "the next frame finds some again";
  cv::setNumThreads(opencv_threads);
}

TEST(Match, AWindowThatNobodyCanSearchIsTooUncertain) {
  const ShotMap& map = textured_map();
  MapReader reader = MapReader::open_unverified(map.path);
  const cv::Mat frame = testing::frame_over(map.ground, 0, 0, {}, 60).gray;
  MatchPrior prior = prior_of(map, {});
  for (const double sigma_m : {1000.0, 100000.0}) {  // at 0.5 m/px and three sigmas beyond 4096 px
    prior.covariance_en_m2 = isotropic_covariance_m2(sigma_m);
    EXPECT_EQ(match(frame, prior, map.ground.camera, reader).status, MatchStatus::kTooUncertain) << sigma_m;
  }
  MatchOptions options;
  options.yaw_sigma_deg = 57;
  options.height_sigma_fraction = 0.5;
  prior.covariance_en_m2 = isotropic_covariance_m2(500);
  EXPECT_EQ(match(frame, prior, map.ground.camera, reader, options).status, MatchStatus::kTooUncertain);
  prior.covariance_en_m2 = isotropic_covariance_m2(2e5);
  EXPECT_EQ(match(frame, prior, map.ground.camera, reader).status, MatchStatus::kBadPrior) << "not on this Earth";
}

TEST(Match, AWideWindowFindsWhatANarrowOneDoes) {
  const ShotMap& map = textured_map();
  MapReader reader = MapReader::open_unverified(map.path);
  for (const Eigen::Vector2d& truth_m : {Eigen::Vector2d(12, -9), Eigen::Vector2d(-20, 15)}) {
    Shot shot;
    shot.east_m = truth_m.x();
    shot.north_m = truth_m.y();
    shot.attitude = {75, 2, -1};
    const cv::Mat frame = testing::frame_over(map.ground, shot.east_m, shot.north_m, shot.attitude, 60).gray;
    MatchPrior prior = prior_of(map, shot);
    const MatchResult narrow = match(frame, prior, map.ground.camera, reader);
    ASSERT_EQ(narrow.status, MatchStatus::kFix);
    for (const bool chips : {false, true}) {
      MatchOptions options;
      options.chips = chips;  // those of this map are as fine as its pixels: of twice the window they are too many
      prior.position = map.place(150, -200);
      prior.covariance_en_m2 = isotropic_covariance_m2(chips ? 200 : 400);
      const MatchResult wide = match(frame, prior, map.ground.camera, reader, options);
      ASSERT_EQ(wide.status, MatchStatus::kFix) << chips;
      EXPECT_LT(geodesic_between(narrow.fix->center, wide.fix->center).length_m, 0.2) << chips;
      EXPECT_EQ(wide.stats.chip_pixels > 0, chips);
      EXPECT_LE(wide.stats.confidence, narrow.stats.confidence) << "more ground, more places that may deceive";
    }
  }
}

/// All numbers of a result in a row.
std::vector<double> numbers_of(const MatchResult& result) {
  const MatchStats& stats = result.stats;
  std::vector<double> all{static_cast<double>(result.status),
                          static_cast<double>(stats.frame_features),
                          static_cast<double>(stats.map_features),
                          stats.support,
                          static_cast<double>(stats.expected_features),
                          stats.vote_peak,
                          stats.vote_rival,
                          static_cast<double>(stats.inliers),
                          stats.residual_m,
                          stats.ncc,
                          stats.ncc_rival,
                          static_cast<double>(stats.chip_pixels),
                          stats.confidence};
  if (!result.candidate) return all;
  const Fix& fix = *result.candidate;
  for (const double value : {fix.position.lon_deg, fix.position.lat_deg, fix.center.lon_deg, fix.center.lat_deg,
                             fix.yaw_deg, fix.pitch_deg, fix.roll_deg, fix.height_agl_m, fix.yaw_sigma_deg,
                             fix.height_sigma_m, fix.scale, static_cast<double>(fix.tile_id.value_or(-1))}) {
    all.push_back(value);
  }
  for (int i = 0; i < 4; ++i) all.push_back(fix.covariance_en_m2(i));
  for (int i = 0; i < 4; ++i) all.push_back(fix.center_covariance_en_m2(i));
  return all;
}

// Frames that overlap, with a reader for each frame, with readers that keep all tiles, some and none.
TEST(Match, TheCacheOfTilesChangesNoResult) {
  const ShotMap& map = textured_map();
  MapReader keeps_all = MapReader::open_unverified(map.path);
  MapReader keeps_some = MapReader::open_unverified(map.path, 400'000);
  MapReader keeps_none = MapReader::open_unverified(map.path, 0);
  int fixes = 0;
  for (int i = 0; i < 8; ++i) {
    Shot shot;
    shot.east_m = -21 + 6 * i;
    shot.north_m = 3 * i - 10;
    const cv::Mat frame = testing::frame_over(map.ground, shot.east_m, shot.north_m, shot.attitude, shot.height_m).gray;
    MapReader fresh = MapReader::open_unverified(map.path);
    const MatchResult result = match(frame, prior_of(map, shot), map.ground.camera, fresh);
    const auto expected = numbers_of(result);
    fixes += result.fix ? 1 : 0;
    for (MapReader* const reader : {&keeps_all, &keeps_some, &keeps_none}) {
      EXPECT_EQ(numbers_of(match(frame, prior_of(map, shot), map.ground.camera, *reader)), expected) << i;
    }
  }
  EXPECT_GT(fixes, 5);
}

TEST(Match, TheSameWheneverAndFromWhicheverThread) {
  const ShotMap& map = textured_map();
  Shot shot;
  shot.attitude = {123, 3, -2};
  shot.attitude_off = {1, -0.5, 0.7};
  const cv::Mat frame = testing::frame_over(map.ground, 0, 0, shot.attitude, 60).gray;
  const MatchPrior prior = prior_of(map, shot);
  const auto answer = [&] {
    MapReader reader = MapReader::open_unverified(map.path);
    match(cv::Mat(frame.size(), CV_8U, cv::Scalar(0)), prior, map.ground.camera, reader);
    return numbers_of(match(frame, prior, map.ground.camera, reader));
  };
  const std::vector<double> expected = answer();
  EXPECT_GT(expected.size(), 20U);
  EXPECT_EQ(answer(), expected);
  std::vector<double> of_thread[2];
  std::thread first([&] { of_thread[0] = answer(); });
  std::thread second([&] { of_thread[1] = answer(); });
  first.join();
  second.join();
  EXPECT_EQ(of_thread[0], expected);
  EXPECT_EQ(of_thread[1], expected);
  for (const int threads : {1, 2}) {
    cv::setNumThreads(threads);
    EXPECT_EQ(answer(), expected) << threads << " threads of OpenCV";
  }
  cv::setNumThreads(-1);
}

}  // namespace
}  // namespace pilotage
