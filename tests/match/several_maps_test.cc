#include <algorithm>
#include <filesystem>
#include <vector>

#include "match/shot.h"
#include "testing/temporary_folder.h"
#include "testing/textured_map.h"
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "pilotage/base/random.h"
#include "pilotage/geo/local_frame.h"
#include "pilotage/mapdb/parallel_reading.h"
#include "pilotage/match/match.h"
#include "pilotage/match/match_confidence.h"
#include "pilotage/match/position_measurement.h"
#include "pilotage/vision/feature_options.h"

namespace pilotage {
namespace {

using testing::prior_of;
using testing::Shot;
using testing::ShotMap;
using testing::TexturedGround;

/// The same texture, whose georeference says that it lies so far to the east.
TexturedGround shifted_ground(double east_m) {
  TexturedGround ground = testing::make_textured_ground();
  ground.gray.map_from_pixel = ground.gray.map_from_pixel.shifted(east_m / ground.gray.map_from_pixel.x_per_col, 0);
  return ground;
}

cv::Mat pixels_of(const TexturedGround& ground) {
  return ground.gray.read({0, 0, static_cast<int>(ground.gray.width_px), static_cast<int>(ground.gray.height_px)})
      .pixels.clone();
}

TexturedGround ground_of(const cv::Mat& pixels) {
  TexturedGround ground = testing::make_textured_ground();
  ground.gray =
      gray_source_from(Raster{pixels, cv::Mat(pixels.size(), CV_8U, cv::Scalar(255)), ground.gray.map_from_pixel});
  return ground;
}

/// Texture that is nowhere in the other.
TexturedGround mirrored_ground() {
  cv::Mat mirrored;
  cv::flip(pixels_of(testing::make_textured_ground()), mirrored, 1);
  return ground_of(mirrored);
}

/// What lies west of the middle lies east of it, too, 80 m away, with a little noise on it.
TexturedGround repeating_ground() {
  cv::Mat pixels = pixels_of(testing::make_textured_ground());
  const int half_px = pixels.cols / 2;
  constexpr int kCopyOffPx = 160;
  Random random(seed_from_name("the copy"));
  for (int row = 0; row < pixels.rows; ++row) {
    for (int col = pixels.cols - 1; col >= std::max(half_px, kCopyOffPx); --col) {
      pixels.at<unsigned char>(row, col) =
          cv::saturate_cast<unsigned char>(pixels.at<unsigned char>(row, col - kCopyOffPx) + 2 * random.normal());
    }
  }
  return ground_of(pixels);
}

FeatureOptions fewer_features(double per_mpx = 5000) {
  FeatureOptions fewer;
  fewer.features_per_mpx = per_mpx;
  return fewer;
}

/// Maps that say of the frame below what each test is about.
struct Maps {
  ShotMap right{testing::make_textured_ground()};
  ShotMap other{mirrored_ground()};
  ShotMap beside{shifted_ground(15)};
};

const Maps& maps() {
  static const Maps kMaps;
  return kMaps;
}

/// What the aircraft sees, so noisy.
cv::Mat frame_with_noise(double sigma) {
  cv::Mat gray = testing::frame_over(maps().right.ground, 0, 0, {}, 60).gray;
  Random random(seed_from_name("noise of the frame"));
  for (auto& pixel : cv::Mat_<unsigned char>(gray)) {
    pixel = cv::saturate_cast<unsigned char>(pixel + sigma * random.normal());
  }
  return gray;
}

MatchResult match_on(const std::vector<const ShotMap*>& asked, const cv::Mat& frame, const MatchOptions& options = {},
                     const MatchPrior& prior = prior_of(maps().right, Shot{})) {
  std::vector<MapReader> readers;
  for (const ShotMap* map : asked) readers.push_back(MapReader::open_unverified(map->path));
  return match(frame, prior, maps().right.ground.camera, pointers_to(readers), options);
}

double error_m(const Fix& fix) {
  return LocalFrame(maps().right.ground.center).enu_from_geodetic(fix.position).head<2>().norm();
}

TEST(SeveralMaps, TheOneThatShowsTheGroundAnswersWhicheverComesFirst) {
  const cv::Mat frame = frame_with_noise(0);
  const MatchResult alone = match_on({&maps().right}, frame);
  ASSERT_TRUE(alone.fix);
  EXPECT_EQ(alone.map_index, 0U);
  for (const std::size_t place : {0U, 1U, 2U}) {
    std::vector<const ShotMap*> asked(3, &maps().other);
    asked[place] = &maps().right;
    const MatchResult result = match_on(asked, frame);
    ASSERT_EQ(result.status, MatchStatus::kFix) << place;
    EXPECT_EQ(result.map_index, place);
    EXPECT_LT(error_m(*result.fix), 0.7);
    EXPECT_EQ(result.fix->position.lon_deg, alone.fix->position.lon_deg) << "its answer, and no mixture";
    EXPECT_EQ(result.stats.vote_peak, alone.stats.vote_peak);
    ASSERT_EQ(result.map_statuses.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(result.map_statuses[i] == MatchStatus::kFix, i == place) << i;
  }
}

TEST(SeveralMaps, TheirErrorsAreNotTheSame) {
  const MatchPrior prior = prior_of(maps().right, Shot{});
  const MatchResult alone = match_on({&maps().right}, frame_with_noise(0));
  const MatchResult two = match_on({&maps().right, &maps().other}, frame_with_noise(0));
  ASSERT_TRUE(alone.fix && two.fix);
  EXPECT_EQ(two.fix->map_sigma_m, alone.fix->map_sigma_m);
  EXPECT_EQ(without_prior(*alone.fix, prior).map_sigma_m, kUnknownMapSigma_m);
  EXPECT_EQ(without_prior(*two.fix, prior).map_sigma_m, 0) << "nothing of it is the error of the next fix";
  EXPECT_EQ(without_prior(*two.fix, prior).covariance_en_m2, without_prior(*alone.fix, prior).covariance_en_m2);
}

TEST(SeveralMaps, OfTwoThatAgreeTheSurerAnswers) {
  const cv::Mat frame = frame_with_noise(20);
  const ShotMap few(testing::make_textured_ground(), fewer_features());
  const MatchResult weak = match_on({&few}, frame);
  const MatchResult strong = match_on({&maps().right}, frame);
  ASSERT_TRUE(weak.fix && strong.fix);
  ASSERT_LT(weak.stats.vote_peak, strong.stats.vote_peak);
  const MatchResult both = match_on({&few, &maps().right}, frame);
  ASSERT_TRUE(both.fix);
  EXPECT_EQ(both.map_index, 1U);
  EXPECT_EQ(both.stats.vote_peak, strong.stats.vote_peak);
}

TEST(SeveralMaps, TwoPlacesThatBothAreSureOfAreAmbiguous) {
  const cv::Mat frame = frame_with_noise(0);
  const MatchResult moved = match_on({&maps().beside}, frame);
  ASSERT_TRUE(moved.fix);
  ASSERT_NEAR(error_m(*moved.fix), 15, 0.7);
  const MatchResult result = match_on({&maps().right, &maps().beside}, frame);
  EXPECT_EQ(result.status, MatchStatus::kAmbiguous);
  EXPECT_FALSE(result.fix);
  EXPECT_TRUE(result.candidate);
  EXPECT_GE(result.stats.vote_rival, 0.9 * moved.stats.vote_peak) << "the other map's place is the rival";
}

TEST(SeveralMaps, ALeadDoesNotSettleAContradiction) {
  const cv::Mat frame = frame_with_noise(0);
  const ShotMap few_beside(shifted_ground(15), fewer_features());
  const MatchResult strong = match_on({&maps().right}, frame);
  const MatchResult weak = match_on({&few_beside}, frame);
  ASSERT_TRUE(strong.fix && weak.fix);
  ASSERT_GT(strong.stats.vote_peak - weak.stats.vote_peak, least_lead(strong.stats.vote_peak, weak.stats.vote_peak));
  EXPECT_EQ(match_on({&few_beside, &maps().right}, frame).status, MatchStatus::kAmbiguous);
}

TEST(SeveralMaps, MapsThatLieApartByMoreThanTheySayContradictEachOther) {
  const cv::Mat frame = frame_with_noise(0);
  const ShotMap near(shifted_ground(7));
  TexturedGround unsure = shifted_ground(7);
  unsure.map_sigma_m = 5;
  const ShotMap unsure_near(unsure);
  ASSERT_TRUE(match_on({&near}, frame).fix);
  EXPECT_EQ(match_on({&maps().right, &near}, frame).status, MatchStatus::kAmbiguous);
  EXPECT_EQ(match_on({&maps().right, &unsure_near}, frame).status, MatchStatus::kFix) << "it says so itself";
}

TEST(SeveralMaps, GroundThatWasBuiltTwiceSinceOneMapIsAmbiguousOnBoth) {
  Shot west;
  west.east_m = -40;
  const ShotMap twice(repeating_ground());
  const ShotMap few(testing::make_textured_ground(), fewer_features(1000));
  const cv::Mat frame = testing::frame_over(maps().right.ground, west.east_m, 0, {}, 60).gray;
  MatchPrior prior = prior_of(maps().right, west);
  prior.covariance_en_m2 = isotropic_covariance_m2(35);
  MatchOptions options;
  options.chips = false;
  const auto match_both_on = [&](const std::vector<const ShotMap*>& asked) {
    return match_on(asked, frame, options, prior);
  };
  const MatchResult alone = match_both_on({&few});
  const MatchResult repeated = match_both_on({&twice});
  ASSERT_EQ(alone.status, MatchStatus::kFix);
  ASSERT_EQ(repeated.status, MatchStatus::kAmbiguous);
  ASSERT_LT(LocalFrame(repeated.candidate->center).enu_from_geodetic(alone.fix->center).head<2>().norm(), 2);
  EXPECT_EQ(match_both_on({&few, &twice}).status, MatchStatus::kAmbiguous)
      << alone.stats.vote_peak << " " << repeated.stats.vote_peak << " " << repeated.stats.vote_rival;
  EXPECT_EQ(match_both_on({&few, &maps().right}).status, MatchStatus::kFix) << "without the copy";
}

TEST(SeveralMaps, EachHasItsShareOfTheRateOfFalseFixes) {
  // A frame so noisy that its place is not beyond all doubt.
  MatchOptions options;
  options.chips = false;
  MatchResult alone;
  cv::Mat frame;
  for (double noise = 40; noise < 400 && !(alone.candidate && 1 - alone.stats.confidence > 1e-5); noise *= 1.05) {
    frame = frame_with_noise(noise);
    alone = match_on({&maps().right}, frame, options);
  }
  const double doubt = 1 - alone.stats.confidence;
  ASSERT_GT(doubt, 1e-5);
  ASSERT_LT(doubt, 0.2);
  options.max_false_fix_rate = 1.5 * doubt;
  const MatchResult one = match_on({&maps().right}, frame, options);
  const MatchResult two = match_on({&maps().right, &maps().other}, frame, options);
  EXPECT_EQ(one.stats.vote_peak, two.stats.vote_peak);
  EXPECT_NEAR(1 - two.stats.confidence, 2 * doubt, 1e-9);
  EXPECT_NE(one.status, MatchStatus::kInconsistent) << "sure enough for one map";
  EXPECT_EQ(two.status, MatchStatus::kInconsistent) << "and not for the better of two";

  options.yaw_sigma_deg = 5;  // three headings, on each map
  const double doubt_of_three = 1 - match_on({&maps().right}, frame, options).stats.confidence;
  ASSERT_LT(doubt_of_three, 0.5);
  EXPECT_NEAR(1 - match_on({&maps().right, &maps().other}, frame, options).stats.confidence, 2 * doubt_of_three, 1e-9);
}

TEST(SeveralMaps, AMapThatCannotBeAskedHidesNoFixAndIsNoRefusal) {
  const testing::TemporaryFolder folder;
  std::filesystem::copy_file(maps().other.path, folder / "broken.gpkg");
  std::vector<MapReader> readers;
  readers.push_back(MapReader::open_unverified(maps().right.path));
  readers.push_back(MapReader::open_unverified(folder / "broken.gpkg"));
  std::filesystem::resize_file(folder / "broken.gpkg", std::filesystem::file_size(folder / "broken.gpkg") / 2);
  const MatchPrior prior = prior_of(maps().right, Shot{});
  const Camera& camera = maps().right.ground.camera;
  const MatchResult found = match(frame_with_noise(0), prior, camera, pointers_to(readers));
  EXPECT_EQ(found.status, MatchStatus::kFix);
  EXPECT_EQ(found.map_index, 0U);
  cv::Mat nothing(120, 160, CV_8U);
  cv::randu(nothing, 0, 255);
  const MatchResult lost = match(nothing, prior, camera, pointers_to(readers));
  EXPECT_EQ(lost.status, MatchStatus::kMapUnreadable);
  EXPECT_EQ(lost.map_index, 1U);
}

TEST(SeveralMaps, AMapThatIsTooMuchToSearchIsNoRefusal) {
  const ShotMap few(testing::make_textured_ground(), fewer_features());
  cv::Mat nothing(120, 160, CV_8U);
  cv::randu(nothing, 0, 255);
  MatchOptions options;
  const auto is_too_much = [&](const ShotMap& map) {
    return match_on({&map}, nothing, options).status == MatchStatus::kTooUncertain;
  };
  options.max_memory_mib = 64;
  while (!is_too_much(maps().right)) options.max_memory_mib /= 1.02;
  ASSERT_FALSE(is_too_much(few)) << options.max_memory_mib;
  const MatchResult both = match_on({&few, &maps().right}, nothing, options);
  EXPECT_EQ(both.status, MatchStatus::kTooUncertain);
  EXPECT_EQ(both.map_index, 1U);
}

TEST(SeveralMaps, NoMapAndNoTimeHaveTheirStatus) {
  const cv::Mat frame = frame_with_noise(0);
  EXPECT_EQ(match_on({}, frame).status, MatchStatus::kNoMap);
  MatchOptions options;
  options.deadline_ms = 0;
  EXPECT_EQ(match_on({&maps().right, &maps().other}, frame, options).status, MatchStatus::kOutOfTime);
  options.max_false_fix_rate = 2;
  EXPECT_EQ(match_on({}, frame, options).status, MatchStatus::kBadOptions);
}

}  // namespace
}  // namespace pilotage
