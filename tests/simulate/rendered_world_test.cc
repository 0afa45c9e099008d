#include "pilotage/simulate/rendered_world.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

const Camera kWorldCamera{80, 60, 70, 70, 40, 30};

TEST(MakeRenderedWorld, OtherHeightsWantALineAboveSeaLevel) {
  Mission mission;
  mission.flight.samples.resize(3);
  for (FlightSample& sample : mission.flight.samples) sample.agl_m = 120;
  EXPECT_THROW(make_rendered_world(mission, "world.tif", "heights.tif"), UsageError);
}

TEST(BlurByMotion, IsTheMeanAlongTheWay) {
  cv::Mat dot = cv::Mat::zeros(41, 41, CV_8UC1);
  dot.at<std::uint8_t>(20, 20) = 240;
  cv::Mat still = dot.clone();
  blur_by_motion(still, {0.05, 0.05});
  EXPECT_EQ(cv::norm(still, dot, cv::NORM_INF), 0);
  cv::Mat smeared = dot.clone();
  blur_by_motion(smeared, {8, 0});
  EXPECT_NEAR(smeared.at<std::uint8_t>(20, 20), 30, 2);
  EXPECT_NEAR(cv::sum(smeared)[0], 240, 12);
  EXPECT_EQ(smeared.at<std::uint8_t>(19, 20), 0);
  EXPECT_EQ(smeared.at<std::uint8_t>(20, 26), 0);
  EXPECT_GT(smeared.at<std::uint8_t>(20, 23), 20);
}

TEST(BlurByMotion, TheGroundMovesBackwardsThroughThePicture) {
  const CameraPose pose{{15, 45}, 70, kNaN, {0, 0, 0}};
  // 3 m to the north at 1 m a pixel: the ground goes down the image.
  EXPECT_LT((motion_in_image(kWorldCamera, pose, {0, 3}) - Eigen::Vector2d(0, 3)).norm(), 1e-9);
  EXPECT_LT((motion_in_image(kWorldCamera, pose, {2, 0}) - Eigen::Vector2d(-2, 0)).norm(), 1e-9);
}

}  // namespace
}  // namespace pilotage
