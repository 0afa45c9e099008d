#include "pilotage/match/direction_search.h"

#include <limits>

#include "match/chip_scene.h"
#include <gtest/gtest.h>

#include "pilotage/base/nan.h"

namespace pilotage {
namespace {

using Eigen::Vector2d;

constexpr int kLevelPixels = 2;  // along a side of one of the mosaic
constexpr double kExclusionPx = 16;

/// Gray values as another season and sensor may have them: darker where the ground is wet, no brighter than before
/// elsewhere, and noisy.
cv::Mat of_another_date(const cv::Mat& ground, std::uint64_t seed) {
  Random random(seed);
  cv::Mat wet = testing::random_ground(ground.cols, ground.rows, seed);
  cv::GaussianBlur(wet, wet, {}, 12);
  cv::Mat changed = ground.clone();
  for (int y = 0; y < ground.rows; ++y) {
    for (int x = 0; x < ground.cols; ++x) {
      const double gain = 0.4 + 0.005 * wet.at<std::uint8_t>(y, x);
      changed.at<std::uint8_t>(y, x) =
          cv::saturate_cast<std::uint8_t>(gain * ground.at<std::uint8_t>(y, x) + 6 * random.normal());
    }
  }
  return changed;
}

class DirectionSearch : public ::testing::Test {
 protected:
  const cv::Mat ground_ = testing::random_ground(200, 190, 41);
  const ChipMosaic mosaic_ = testing::mosaic_of(ground_, 300, 600, kLevelPixels);
  const std::vector<double> turns_deg_{-2, 0, 2};

  std::optional<DirectionSurface> search(const RectifiedFrame& frame, const Vector2d& center_px,
                                         double half_width_px = 50) const {
    return search_directions(frame, mosaic_, level(center_px), half_width_px, turns_deg_);
  }
  /// In pixels of the level.
  Vector2d level(const Vector2d& mosaic_px) const { return mosaic_.level_from_mosaic(mosaic_px); }
};

TEST_F(DirectionSearch, FindsTheNadirOfAFrameOfAnotherDate) {
  const cv::Mat later = of_another_date(ground_, 42);
  for (const double yaw_deg : {-1.5, 0.0, 1.5}) {
    for (const Vector2d& truth_px : {Vector2d(100, 95), Vector2d(91.4, 103.6)}) {
      const RectifiedFrame frame = testing::frame_over(later, truth_px, 60, 50, 30, yaw_deg, 1.02);
      const auto surface = search(frame, truth_px + Vector2d(7, -9));
      ASSERT_TRUE(surface);
      const std::vector<DirectionPlace> places = direction_places(*surface, 2, kExclusionPx);
      ASSERT_GE(places.size(), 1U);
      EXPECT_LE((places.front().nadir_px - level(truth_px)).norm(), 2 * kLevelPixels);
      EXPECT_EQ(surface->at(level(truth_px)), places.front().agreement);
      EXPECT_GT(places.front().agreement, 8);
      if (places.size() > 1) {
        EXPECT_LT(places[1].agreement, 0.6 * places.front().agreement);
      }
    }
  }
}

TEST_F(DirectionSearch, NothingAgreesWithOtherGround) {
  double most = 0;
  for (std::uint64_t seed = 50; seed < 70; ++seed) {
    const cv::Mat other = testing::random_ground(200, 190, seed);
    const RectifiedFrame frame = testing::frame_over(other, {100, 95}, 60, 50);
    const auto surface = search(frame, {100, 95}, 58);
    ASSERT_TRUE(surface);
    for (const DirectionPlace& place : direction_places(*surface, 1, kExclusionPx)) {
      most = std::max(most, place.agreement);
    }
  }
  EXPECT_GT(most, 2) << "chance has something of every window";
  EXPECT_LT(most, 6);
}

// One line that both have is no evidence: it rules one row of parts, and these do not rule the sum.
TEST_F(DirectionSearch, OneRoadDoesNotRule) {
  cv::Mat here = ground_.clone();
  cv::Mat there = testing::random_ground(200, 190, 43);
  for (cv::Mat* picture : {&here, &there}) cv::line(*picture, {0, 95}, {199, 95}, cv::Scalar(250), 3);
  const ChipMosaic mosaic = testing::mosaic_of(here, 300, 600, kLevelPixels);
  const RectifiedFrame frame = testing::frame_over(there, {100, 95}, 60, 60);
  const auto surface = search_directions(frame, mosaic, mosaic.level_from_mosaic({100, 95}), 50, turns_deg_);
  ASSERT_TRUE(surface);
  const auto places = direction_places(*surface, 1, kExclusionPx);
  ASSERT_EQ(places.size(), 1U);
  EXPECT_LT(places.front().agreement, 9);
}

TEST_F(DirectionSearch, WhatIsNotKnownIsNoGround) {
  ChipMosaic half = mosaic_;
  half.valid(cv::Rect(0, 0, 100, 190)).setTo(0);
  half.gray(cv::Rect(0, 0, 100, 190)).setTo(0);
  half.gray = half.gray.clone();
  const RectifiedFrame frame = testing::frame_over(ground_, {140, 95}, 60, 50);
  const auto surface = search_directions(frame, half, half.level_from_mosaic({130, 95}), 100, {0});
  ASSERT_TRUE(surface);
  EXPECT_LE((direction_places(*surface, 1, kExclusionPx).front().nadir_px - level({140, 95})).norm(),
            1.5 * kLevelPixels);
  const Vector2d unknown = (level({85, 95}) - surface->first_px) / surface->step_px;
  EXPECT_EQ(surface->agreement.at<float>(static_cast<int>(unknown.y()), static_cast<int>(unknown.x())),
            DirectionSurface::kNotCompared);
  half.valid.setTo(0);
  EXPECT_FALSE(search_directions(frame, half, half.level_from_mosaic({130, 95}), 50, {0}));
}

// Where there are no chips nothing is compared, and it must not make the rest look rare.
TEST_F(DirectionSearch, WhereChipsAreSparseChanceIsNoMore) {
  ChipMosaic edge = mosaic_;
  edge.valid = mosaic_.valid.clone();
  edge.valid.colRange(0, 120).setTo(0);
  double sum = 0;
  double sum_of_all = 0;
  for (std::uint64_t seed = 50; seed < 70; ++seed) {
    const RectifiedFrame frame = testing::frame_over(testing::random_ground(200, 190, seed), {100, 95}, 60, 50);
    const auto sparse = search_directions(frame, edge, level({100, 95}), 100, turns_deg_);
    const auto whole = search(frame, {100, 95}, 100);
    ASSERT_TRUE(sparse && whole);
    sum += direction_places(*sparse, 1, kExclusionPx).front().agreement / 20;
    sum_of_all += direction_places(*whole, 1, kExclusionPx).front().agreement / 20;
  }
  EXPECT_LT(sum, sum_of_all + 0.1);
}

TEST_F(DirectionSearch, ATurnThatTakesPartsTooFarIsNotCompared) {
  RectifiedFrame aside = testing::frame_over(ground_, {100, 95}, 60, 50);
  aside.origin_m.x() += 500 * aside.gsd_m;  // the nadir point lies that far beside
  const auto surface = search_directions(aside, mosaic_, level({-400, 95}), 50, {-5, 0, 5});
  ASSERT_TRUE(surface);
  EXPECT_EQ(surface->turns_deg, std::vector<double>{0});
  EXPECT_LE((direction_places(*surface, 1, kExclusionPx).front().nadir_px - level({-400, 95})).norm(),
            2 * kLevelPixels);
  EXPECT_FALSE(search_directions(aside, mosaic_, level({-400, 95}), 50, {-5, 5}));
}

TEST_F(DirectionSearch, ANarrowWindowIsJudgedByTheGroundAround) {
  const cv::Mat later = of_another_date(ground_, 44);
  const RectifiedFrame frame = testing::frame_over(later, {100, 95}, 60, 50);
  const auto wide = search(frame, {100, 95}, 58);
  const auto narrow = search(frame, {100, 95}, 6);
  ASSERT_TRUE(wide && narrow);
  EXPECT_EQ(narrow->agreement.cols, 7);
  EXPECT_EQ(narrow->reach(), 3);
  EXPECT_NEAR(narrow->at(level({100, 95})), wide->at(level({100, 95})), 1e-3);
  EXPECT_EQ(narrow->at(level({120, 95})), 0) << "outside";
}

TEST_F(DirectionSearch, TheTurnOfThePlaceIsSaid) {
  const cv::Mat ground = testing::random_ground(260, 250, 45);
  const ChipMosaic mosaic = testing::mosaic_of(ground, 300, 600, kLevelPixels);
  const Vector2d center_px = mosaic.level_from_mosaic({130, 125});
  for (const double yaw_deg : {-5.0, 5.0}) {
    const RectifiedFrame frame = testing::frame_over(ground, {130, 125}, 90, 60, 0, yaw_deg);
    const auto surface = search_directions(frame, mosaic, center_px, 40, {-5, 0, 5});
    ASSERT_TRUE(surface);
    const DirectionPlace place = direction_places(*surface, 1, kExclusionPx).front();
    EXPECT_LE((place.nadir_px - center_px).norm(), 2 * kLevelPixels);
    EXPECT_EQ(place.turn_deg, yaw_deg);
    const auto not_turned = search_directions(frame, mosaic, center_px, 40, {0});
    ASSERT_TRUE(not_turned);
    EXPECT_LT(not_turned->at(center_px), place.agreement);
  }
}

TEST_F(DirectionSearch, LargeFramesAndWideWindowsAreComparedMoreCoarsely) {
  const cv::Mat ground = testing::random_ground(460, 440, 46);
  const ChipMosaic mosaic = testing::mosaic_of(ground, 300, 600, kLevelPixels);
  const Vector2d truth_px = mosaic.level_from_mosaic({231, 217});
  const RectifiedFrame large = testing::frame_over(of_another_date(ground, 47), {231, 217}, 100, 80);
  ASSERT_GT(large.gray.cols, kMostDirectionSide);
  for (const double half_width_px : {50.0, 2.0 * kLevelPixels * kMostDirectionReach}) {
    const auto surface = search_directions(large, mosaic, truth_px + Vector2d(11, -13), half_width_px, turns_deg_);
    ASSERT_TRUE(surface);
    EXPECT_EQ(surface->step_px, 2 * kLevelPixels);
    EXPECT_EQ(surface->reach(), half_width_px / surface->step_px + (half_width_px == 50 ? 0.5 : 0));
    const DirectionPlace place = direction_places(*surface, 1, kExclusionPx).front();
    EXPECT_LE((place.nadir_px - truth_px).norm(), 2 * surface->step_px);
    EXPECT_GT(place.agreement, 7);
  }
  const RectifiedFrame small = testing::frame_over(ground_, {100, 95}, 60, 50);
  EXPECT_TRUE(search(small, {100, 95}, kLevelPixels * kMostDirectionReach));
  EXPECT_FALSE(search(small, {100, 95}, kLevelPixels * kMostDirectionReach + 1))
      << "of half as many pixels along a side too few are left";
}

TEST_F(DirectionSearch, MemoryIsSaidBeforeItIsTaken) {
  EXPECT_GT(direction_search_bytes(40, 30), 1e6);
  EXPECT_LT(direction_search_bytes(kMaxMosaicSidePx, 1e9), 40e6) << "as of the largest that is compared";
}

TEST_F(DirectionSearch, AnythingIsAnswered) {
  const RectifiedFrame frame = testing::frame_over(ground_, {100, 95}, 60, 50);
  const Vector2d center_px = mosaic_.level_from_mosaic({100, 95});
  EXPECT_FALSE(search_directions({}, mosaic_, center_px, 50, {0}));
  EXPECT_FALSE(search_directions(frame, {}, center_px, 50, {0}));
  EXPECT_FALSE(search_directions(frame, mosaic_, {kNaN, 0}, 50, {0}));
  EXPECT_FALSE(search_directions(frame, mosaic_, center_px, kNaN, {0}));
  EXPECT_FALSE(search_directions(frame, mosaic_, center_px, 1e9, {0}));
  EXPECT_FALSE(search_directions(frame, mosaic_, center_px, 50, {}));
  EXPECT_FALSE(search_directions(frame, mosaic_, center_px, 50, {kNaN}));
  EXPECT_FALSE(search_directions(frame, mosaic_, center_px, 50, std::vector<double>(256)));
  EXPECT_TRUE(search_directions(frame, mosaic_, center_px, 50, {720})) << "a turn of any size is one";
  RectifiedFrame nowhere = frame;
  nowhere.origin_m.x() = kNaN;
  EXPECT_FALSE(search_directions(nowhere, mosaic_, center_px, 50, {0}));
  ChipMosaic sliver = mosaic_;
  sliver.gray = mosaic_.gray.row(0);
  sliver.valid = mosaic_.valid.row(0);
  EXPECT_FALSE(search_directions(frame, sliver, center_px, 400, {0}));
  EXPECT_FALSE(search_directions(frame, mosaic_, center_px + Vector2d(5000, 0), 50, {0})) << "beside the chips";
  RectifiedFrame flat = frame;
  flat.gray = cv::Mat(frame.gray.size(), CV_8UC1, cv::Scalar(100));
  EXPECT_FALSE(search_directions(flat, mosaic_, center_px, 50, {0}));
  const auto surface = search(frame, {100, 95});
  ASSERT_TRUE(surface);
  EXPECT_EQ(surface->at({kNaN, 0}), 0);
  EXPECT_EQ(surface->at({1e12, 0}), 0);
  EXPECT_TRUE(direction_places(*surface, 0, 8).empty());
}

TEST(DirectionField, HasTheDirectionOfAnEdgeAndNothingOfItsLight) {
  cv::Mat ramp(40, 40, CV_8UC1);
  for (int x = 0; x < 40; ++x) ramp.col(x).setTo(x < 20 ? 50 : 150);
  const cv::Mat valid(ramp.size(), CV_8UC1, cv::Scalar(255));
  const std::vector<cv::Mat> field = direction_field(ramp, valid);
  ASSERT_EQ(field.size(), 8U);
  const cv::Point at(19, 20);
  for (const std::size_t cosine : {0, 2, 4}) EXPECT_GT(field[cosine].at<float>(at), 0.2) << cosine;
  for (const std::size_t sine : {1, 3, 5}) EXPECT_NEAR(field[sine].at<float>(at), 0, 1e-5) << sine;
  const std::vector<cv::Mat> darker = direction_field(cv::Mat(0.5 * ramp), valid);
  EXPECT_NEAR(darker[0].at<float>(at), field[0].at<float>(at), 0.05);
  const std::vector<cv::Mat> inverted = direction_field(cv::Mat(255 - ramp), valid);
  EXPECT_LT(inverted[0].at<float>(at), 0);
  EXPECT_GT(inverted[2].at<float>(at), 0.2) << "twice the direction is that of the opposite one, too";
  const std::vector<cv::Mat> turned = direction_field(ramp.t(), valid);
  const cv::Point there(20, 19);
  EXPECT_NEAR(turned[0].at<float>(there), 0, 1e-5);
  EXPECT_GT(turned[1].at<float>(there), 0.2);
  EXPECT_LT(turned[2].at<float>(there), -0.2);
  EXPECT_LT(turned[5].at<float>(there), -0.2);
}

TEST(DirectionField, KnowsNothingOfWhatIsNotValidOrBeside) {
  const cv::Mat ground = testing::random_ground(60, 50, 48);
  cv::Mat valid(ground.size(), CV_8UC1, cv::Scalar(255));
  valid.colRange(0, 20).setTo(0);
  for (const cv::Mat& plane : direction_field(ground, valid)) {
    EXPECT_EQ(cv::countNonZero(plane.colRange(0, 23)), 0);
    EXPECT_GT(cv::countNonZero(plane.colRange(24, 60)), 0);
  }
}

}  // namespace
}  // namespace pilotage
