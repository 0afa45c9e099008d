#include "pilotage/registration/lit_ground.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace pilotage {
namespace {

/// A lit plain of 100 with one square shadow, of 10 px from (30, 30).
cv::Mat plain_with_shadow(float shadow) {
  cv::Mat pixels(80, 80, CV_32F, cv::Scalar(100));
  pixels(cv::Rect(30, 30, 10, 10)) = shadow;
  return pixels;
}

TEST(LitGround, LeavesOutShadowsAndTwoPixelsAround) {
  const cv::Mat valid(80, 80, CV_8U, cv::Scalar(255));
  const cv::Mat lit = lit_ground(plain_with_shadow(50), valid, 48);
  cv::Mat expected(80, 80, CV_8U, cv::Scalar(255));
  expected(cv::Rect(28, 28, 14, 14)) = 0;
  EXPECT_EQ(cv::norm(lit, expected, cv::NORM_INF), 0);
  EXPECT_EQ(cv::countNonZero(lit_ground(plain_with_shadow(75), valid, 48) == 0), 0);  // a darker field is none
}

TEST(LitGround, WhatIsDarkAllOverIsLit) {
  const cv::Mat valid(80, 80, CV_8U, cv::Scalar(255));
  EXPECT_EQ(cv::countNonZero(lit_ground(cv::Mat(80, 80, CV_32F, cv::Scalar(20)), valid, 48) == 0), 0);
}

TEST(LitGround, WhatIsNoGroundNeitherCountsNorIsLit) {
  cv::Mat valid(80, 80, CV_8U, cv::Scalar(1));
  valid(cv::Rect(0, 0, 20, 80)) = 0;
  for (const float there : {0.F, 1e6F}) {
    cv::Mat pixels = plain_with_shadow(50);
    pixels(cv::Rect(0, 0, 20, 80)) = there;
    const cv::Mat lit = lit_ground(pixels, valid, 48);
    EXPECT_EQ(cv::countNonZero(lit(cv::Rect(0, 0, 20, 80))), 0);
    EXPECT_EQ(cv::countNonZero(lit(cv::Rect(20, 0, 60, 80)) == 0), 14 * 14);
  }
}

}  // namespace
}  // namespace pilotage
