#include "pilotage/vision/direction_field.h"

#include <cmath>
#include <numbers>

#include "match/chip_scene.h"
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace pilotage {
namespace {

cv::Mat all_valid(const cv::Mat& gray) {
  return cv::Mat(gray.size(), CV_8UC1, cv::Scalar(255));
}

/// Stripes that change along `theta_rad` from the columns' direction towards the rows'.
cv::Mat stripes(double theta_rad, int side = 41) {
  cv::Mat gray(side, side, CV_8UC1);
  for (int row = 0; row < side; ++row) {
    for (int col = 0; col < side; ++col) {
      const double along = std::cos(theta_rad) * col + std::sin(theta_rad) * row;
      gray.at<std::uint8_t>(row, col) = static_cast<std::uint8_t>(std::lround(127 + 100 * std::sin(0.4 * along)));
    }
  }
  return gray;
}

TEST(DirectionField, PointsAlongTwiceTheAngleOfTheGradient) {
  for (const double theta_rad : {0.0, 0.4, 1.3, 2.0, 3.0}) {
    const cv::Mat gray = stripes(theta_rad);
    const cv::Mat z = direction_field(gray, all_valid(gray)).z;
    for (auto it = z.begin<cv::Vec2f>(); it != z.end<cv::Vec2f>(); ++it) {
      const double length = std::hypot((*it)[0], (*it)[1]);
      EXPECT_LE(length, 1);
      if (length < 0.3) continue;
      const double off = std::remainder(std::atan2((*it)[1], (*it)[0]) - 2 * theta_rad, 2 * std::numbers::pi);
      EXPECT_LT(std::abs(off), 0.1) << theta_rad;
    }
    EXPECT_GT(cv::norm(z, cv::NORM_L1), 0.2 * z.total());
  }
}

TEST(DirectionField, LightAndShadeMayChangePlaces) {
  const cv::Mat gray = testing::random_ground(60, 50, 3);
  const cv::Mat negative = 255 - gray;
  EXPECT_LT(
      cv::norm(direction_field(gray, all_valid(gray)).z, direction_field(negative, all_valid(gray)).z, cv::NORM_INF),
      1e-4);
}

TEST(DirectionField, HalfOfThePixelsChangeMoreThanTheMedian) {
  const cv::Mat gray = testing::random_ground(90, 80, 4);
  const DirectionField field = direction_field(gray, all_valid(gray));
  const int strong = cv::countNonZero(direction_steps(field.z));
  EXPECT_NEAR(strong, cv::countNonZero(field.valid) / 2.0, 5);
}

TEST(DirectionField, EvenGroundHasNone) {
  const cv::Mat even(30, 30, CV_8UC1, cv::Scalar(77));
  EXPECT_EQ(cv::norm(direction_field(even, all_valid(even)).z, cv::NORM_INF), 0);
  cv::Mat faint = even.clone();
  for (int row = 0; row < faint.rows; row += 2) faint.row(row) += 1;  // the rounding of something even
  EXPECT_EQ(cv::countNonZero(direction_steps(direction_field(faint, all_valid(faint)).z)), 0);
}

TEST(DirectionField, DependsOnValidPixelsOnly) {
  cv::Mat gray = testing::random_ground(60, 50, 5);
  cv::Mat valid = all_valid(gray);
  valid(cv::Rect(20, 15, 9, 7)).setTo(0);
  const DirectionField before = direction_field(gray, valid);
  gray.setTo(255, valid == 0);
  const DirectionField after = direction_field(gray, valid);
  EXPECT_EQ(cv::norm(before.z, after.z, cv::NORM_INF), 0);
  const int reach = kDirectionReachPx;
  cv::Mat expected = cv::Mat::zeros(gray.size(), CV_8UC1);
  expected(cv::Rect(reach, reach, 60 - 2 * reach, 50 - 2 * reach)).setTo(255);
  expected(cv::Rect(20 - reach, 15 - reach, 9 + 2 * reach, 7 + 2 * reach)).setTo(0);
  EXPECT_EQ(cv::norm(before.valid, expected, cv::NORM_INF), 0);
  EXPECT_EQ(cv::countNonZero(direction_steps(before.z) & ~before.valid), 0);
}

TEST(DirectionField, OfAPictureSmallerThanItsReachNothingIsKnown) {
  const cv::Mat gray = testing::random_ground(5, 70, 6);
  EXPECT_EQ(cv::countNonZero(direction_field(gray, all_valid(gray)).valid), 0);
  const cv::Mat one(1, 1, CV_8UC1, cv::Scalar(9));
  EXPECT_EQ(cv::countNonZero(direction_field(one, all_valid(one)).valid), 0);
}

TEST(DirectionSteps, AreTheMiddlesOfTheirSectors) {
  cv::Mat z(1, 720, CV_32FC2);
  for (int i = 0; i < z.cols; ++i) {
    const double angle = (i + 0.5) * 2 * std::numbers::pi / z.cols;
    z.at<cv::Vec2f>(0, i) = {static_cast<float>(0.7 * std::cos(angle)), static_cast<float>(0.7 * std::sin(angle))};
  }
  const cv::Mat steps = direction_steps(z);
  const cv::Mat back = field_from_steps(steps);
  for (int i = 0; i < z.cols; ++i) {
    EXPECT_EQ(steps.at<std::uint8_t>(0, i), 1 + i * kDirectionSectors / z.cols);
    const cv::Vec2f there = back.at<cv::Vec2f>(0, i);
    EXPECT_NEAR(std::hypot(there[0], there[1]), 1, 1e-6);
    EXPECT_GT(there.dot(z.at<cv::Vec2f>(0, i)), 0.7 * std::cos(std::numbers::pi / kDirectionSectors) - 1e-5);
  }
  EXPECT_EQ(cv::countNonZero(direction_steps(0.5 / 0.71 * z)), 0) << "w below one half";
  EXPECT_EQ(cv::norm(field_from_steps(cv::Mat::zeros(3, 3, CV_8UC1)), cv::NORM_INF), 0);
}

}  // namespace
}  // namespace pilotage
