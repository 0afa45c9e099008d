#include "pilotage/match/local_contrast.h"

#include <cmath>

#include "match/chip_scene.h"
#include <gtest/gtest.h>

namespace pilotage {
namespace {

// The definition, summed in double precision over the whole picture.
double contrast_at(const cv::Mat& gray, const cv::Mat& valid, double sigma_px, int col, int row) {
  const auto mean_of = [&](const cv::Mat& values, int x, int y) {
    double total = 0;
    double sum = 0;
    for (int v = 0; v < gray.rows; ++v) {
      for (int u = 0; u < gray.cols; ++u) {
        if (valid.at<std::uint8_t>(v, u) == 0) continue;
        const double weight = std::exp(-0.5 * ((u - x) * (u - x) + (v - y) * (v - y)) / (sigma_px * sigma_px));
        total += weight;
        sum += weight * values.at<double>(v, u);
      }
    }
    return sum / total;
  };
  cv::Mat values;
  gray.convertTo(values, CV_64F);
  cv::Mat squares = cv::Mat::zeros(gray.size(), CV_64F);
  for (int v = 0; v < gray.rows; ++v) {
    for (int u = 0; u < gray.cols; ++u) {
      squares.at<double>(v, u) = std::pow(values.at<double>(v, u) - mean_of(values, u, v), 2);
    }
  }
  const double difference = values.at<double>(row, col) - mean_of(values, col, row);
  return std::clamp(difference / std::sqrt(mean_of(squares, col, row) + kFaintVariance), -kMostContrast, kMostContrast);
}

TEST(LocalContrast, IsTheDifferenceFromTheSurroundingsInTheirSpread) {
  const cv::Mat gray = testing::random_ground(24, 20, seed_from_name("IsTheDifferenceFromTheSurroundings"));
  cv::Mat valid(gray.size(), CV_8UC1, cv::Scalar(255));
  valid(cv::Rect(0, 0, 9, 7)).setTo(0);
  const cv::Mat contrast = local_contrast(gray, valid, 1.5);
  ASSERT_EQ(contrast.type(), CV_32FC1);
  for (const cv::Point& at :
       {cv::Point(12, 10), cv::Point(9, 3), cv::Point(23, 19), cv::Point(4, 7), cv::Point(20, 0)}) {
    // OpenCV cuts the Gaussian at four sigma.
    EXPECT_NEAR(static_cast<double>(contrast.at<float>(at)), contrast_at(gray, valid, 1.5, at.x, at.y), 5e-3) << at;
  }
  EXPECT_EQ(contrast.at<float>(0, 0), 0);
  EXPECT_EQ(cv::countNonZero(contrast(cv::Rect(0, 0, 9, 7))), 0);
}

TEST(LocalContrast, DoesNotSeeWhatIsNotValidNorLightAndHaze) {
  cv::Mat gray = testing::random_ground(40, 40, seed_from_name("DoesNotSeeWhatIsNotValid"));
  cv::Mat valid(gray.size(), CV_8UC1, cv::Scalar(255));
  valid(cv::Rect(20, 0, 20, 40)).setTo(0);
  const cv::Mat before = local_contrast(gray, valid, 2);
  gray.setTo(255, valid == 0);
  EXPECT_LT(cv::norm(before, local_contrast(gray, valid, 2), cv::NORM_INF), 1e-5);
  cv::Mat hazy;
  gray.convertTo(hazy, CV_8U, 0.7, 60);
  const cv::Mat after = local_contrast(hazy, valid, 2);
  EXPECT_GT(before.dot(after) / std::sqrt(before.dot(before) * after.dot(after)), 0.99);
  EXPECT_LE(cv::norm(after, cv::NORM_INF), kMostContrast);
}

}  // namespace
}  // namespace pilotage
