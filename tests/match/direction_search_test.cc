#include "bench/direction_search.h"

#include <limits>

#include "match/chip_scene.h"
#include <gtest/gtest.h>

#include "pilotage/base/nan.h"

namespace pilotage {
namespace {

using Eigen::Vector2d;

constexpr int kLevelPixels = 2;  // along a side of one of the mosaic

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
    return search_directions(frame, mosaic_, mosaic_.level_from_mosaic(center_px), half_width_px, turns_deg_);
  }
};

TEST_F(DirectionSearch, FindsTheNadirOfAFrameOfAnotherDate) {
  const cv::Mat later = of_another_date(ground_, 42);
  for (const double yaw_deg : {-1.5, 0.0, 1.5}) {
    for (const Vector2d& truth_px : {Vector2d(100, 95), Vector2d(91.4, 103.6)}) {
      const RectifiedFrame frame = testing::frame_over(later, truth_px, 60, 50, 30, yaw_deg, 1.02);
      const auto surface = search(frame, truth_px + Vector2d(7, -9));
      ASSERT_TRUE(surface);
      const std::vector<Vector2d> places = direction_places(*surface, 2, 8);
      ASSERT_GE(places.size(), 1U);
      EXPECT_LE((places.front() - truth_px).norm(), 2);
      EXPECT_GT(surface->at(truth_px), 8);
      if (places.size() > 1) {
        EXPECT_LT(surface->at(places[1]), 0.6 * surface->at(truth_px));
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
    for (const Vector2d& place : direction_places(*surface, 1, 8)) most = std::max(most, surface->at(place));
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
  const auto places = direction_places(*surface, 1, 8);
  ASSERT_EQ(places.size(), 1U);
  EXPECT_LT(surface->at(places.front()), 9);
}

TEST_F(DirectionSearch, WhatIsNotKnownIsNoGround) {
  ChipMosaic half = mosaic_;
  half.valid(cv::Rect(0, 0, 100, 190)).setTo(0);
  half.gray(cv::Rect(0, 0, 100, 190)).setTo(0);
  half.gray = half.gray.clone();
  const RectifiedFrame frame = testing::frame_over(ground_, {140, 95}, 60, 50);
  const auto surface = search_directions(frame, half, half.level_from_mosaic({130, 95}), 100, {0});
  ASSERT_TRUE(surface);
  EXPECT_LE((direction_places(*surface, 1, 8).front() - Vector2d(140, 95)).norm(), 1.5);
  EXPECT_EQ(surface->agreement.at<float>(95 - surface->first.y, 85 - surface->first.x), DirectionSurface::kNotCompared);
  half.valid.setTo(0);
  EXPECT_FALSE(search_directions(frame, half, half.level_from_mosaic({130, 95}), 50, {0}));
}

TEST_F(DirectionSearch, ANarrowWindowIsJudgedByTheGroundAround) {
  const cv::Mat later = of_another_date(ground_, 44);
  const RectifiedFrame frame = testing::frame_over(later, {100, 95}, 60, 50);
  const auto wide = search(frame, {100, 95}, 58);
  const auto narrow = search(frame, {100, 95}, 6);
  ASSERT_TRUE(wide && narrow);
  EXPECT_EQ(narrow->agreement.cols, 7);
  EXPECT_NEAR(narrow->at({100, 95}), wide->at({100, 95}), 1e-3);
  EXPECT_EQ(narrow->at({120, 95}), 0) << "outside";
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
  ASSERT_EQ(field.size(), 10U);
  const cv::Point at(19, 20);
  for (std::size_t i = 1; i < 8; ++i) EXPECT_LT(field[i].at<float>(at), field[0].at<float>(at)) << i;
  EXPECT_GT(field[0].at<float>(at), 0.4);
  const std::vector<cv::Mat> darker = direction_field(cv::Mat(0.5 * ramp), valid);
  EXPECT_NEAR(darker[0].at<float>(at), field[0].at<float>(at), 0.05);
  const std::vector<cv::Mat> inverted = direction_field(cv::Mat(255 - ramp), valid);
  EXPECT_LT(inverted[0].at<float>(at), 0);
}

}  // namespace
}  // namespace pilotage
