#include "pilotage/match/reduced_picture.h"

#include <gtest/gtest.h>

namespace pilotage {
namespace {

TEST(ReducedPicture, HasMeansAndDropsWhatIsNoWholePixel) {
  const cv::Mat pixels = (cv::Mat_<float>(3, 5) << 1, 3, 10, 10, 99, 5, 7, 10, 14, 99, 99, 99, 99, 99, 99);
  const cv::Mat result = reduced_picture(pixels, 2);
  ASSERT_EQ(result.size(), cv::Size(2, 1));
  EXPECT_EQ(result.at<float>(0, 0), 4);
  EXPECT_EQ(result.at<float>(0, 1), 11);
}

TEST(ReducedMask, IsValidWhereAllPixelsAre) {
  cv::Mat valid(8, 8, CV_8UC1, cv::Scalar(255));
  valid.at<std::uint8_t>(1, 6) = 0;
  const cv::Mat result = reduced_mask(valid, 4);
  EXPECT_EQ(cv::countNonZero(result), 3);
  EXPECT_EQ(result.at<std::uint8_t>(0, 1), 0);
  EXPECT_EQ(result.at<std::uint8_t>(1, 1), 255);
}

}  // namespace
}  // namespace pilotage
