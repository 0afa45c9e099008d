#include "pilotage/camera/ortho_rectify.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "camera/smooth_ground.h"
#include <Eigen/LU>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "pilotage/base/random.h"
#include "pilotage/camera/projection.h"

namespace pilotage {
namespace {

using testing::distorted;
using testing::smooth_ground_gray;

const Camera kRectifiedCamera{480, 360, 400, 405, 243.5, 176.25};

/// What the camera sees of `gray`, by rays from the pixels: the other direction than the one ortho_rectify computes.
template <class Gray>
cv::Mat render(const Camera& camera, const Attitude& attitude, double agl_m, Gray gray) {
  const auto view = make_view(camera, attitude, agl_m);
  cv::Mat frame(camera.height_px, camera.width_px, CV_8UC1, cv::Scalar(0));
  for (int row = 0; row < frame.rows; ++row) {
    for (int col = 0; col < frame.cols; ++col) {
      const auto ground = ground_from_pixel(*view, {col + 0.5, row + 0.5});
      if (ground) frame.at<std::uint8_t>(row, col) = cv::saturate_cast<std::uint8_t>(gray(*ground));
    }
  }
  return frame;
}

/// The shift (east, north) in metres that best explains gray(p + shift) − result by least squares on the gradient.
Eigen::Vector2d shift_from_truth(const RectifiedFrame& result) {
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  const double h = 1e-3;
  for (int row = 0; row < result.gray.rows; ++row) {
    for (int col = 0; col < result.gray.cols; ++col) {
      if (result.valid.at<std::uint8_t>(row, col) == 0) continue;
      const Eigen::Vector2d p = result.ground_from_pixel({col + 0.5, row + 0.5});
      const Eigen::Vector2d gradient((smooth_ground_gray(p + Eigen::Vector2d(h, 0)) - smooth_ground_gray(p)) / h,
                                     (smooth_ground_gray(p + Eigen::Vector2d(0, h)) - smooth_ground_gray(p)) / h);
      normal += gradient * gradient.transpose();
      right += gradient * (result.gray.at<std::uint8_t>(row, col) - smooth_ground_gray(p));
    }
  }
  return normal.inverse() * right;
}

TEST(OrthoRectify, GivesTheGroundBack) {
  const std::vector<Camera> cameras{
      kRectifiedCamera,
      distorted(kRectifiedCamera, DistortionModel::kBrownConrady, {-0.25, 0.08, 0.002, -0.001, -0.01}),
      distorted(kRectifiedCamera, DistortionModel::kFisheye, {0.02, -0.01, 0.003, 0, 0}),
  };
  const std::vector<Attitude> attitudes{{0, 0, 0}, {152, 1.5, -0.8}, {-70, 18, 12}, {35, -30, 25}};
  for (const Camera& camera : cameras) {
    for (const Attitude& attitude : attitudes) {
      SCOPED_TRACE(::testing::Message() << static_cast<int>(camera.distortion_model) << " " << attitude.yaw_deg);
      const cv::Mat frame = render(camera, attitude, 100, smooth_ground_gray);
      RectifyOptions options;
      options.gsd_m = 0.3;
      const RectifiedFrame result = ortho_rectify(frame, camera, attitude, 100, options);
      ASSERT_EQ(result.status, RectifyStatus::kOk);
      const Eigen::Vector2d shift = shift_from_truth(result);
      EXPECT_LT(shift.norm(), 0.05 * options.gsd_m) << shift.transpose();
      double sum2 = 0;
      for (int row = 0; row < result.gray.rows; ++row) {
        for (int col = 0; col < result.gray.cols; ++col) {
          if (result.valid.at<std::uint8_t>(row, col) == 0) continue;
          const double truth = smooth_ground_gray(result.ground_from_pixel({col + 0.5, row + 0.5}));
          sum2 += std::pow(result.gray.at<std::uint8_t>(row, col) - truth, 2);
        }
      }
      const int count = cv::countNonZero(result.valid);
      EXPECT_LT(std::sqrt(sum2 / count), 2.0);
      // The mask is the footprint but for a border of half a frame pixel.
      const double area = count * options.gsd_m * options.gsd_m;
      const double seen = footprint(*make_view(camera, attitude, 100, options.max_off_nadir_deg)).area_m2;
      EXPECT_NEAR(area / seen, 1, 0.03);
    }
  }
}

TEST(OrthoRectify, OriginIsAWholeNumberOfPixels) {
  const Camera camera = kRectifiedCamera;
  const cv::Mat frame(360, 480, CV_8UC1, cv::Scalar(100));
  const RectifiedFrame result = ortho_rectify(frame, camera, {10, 3, 4}, 77.7);
  ASSERT_EQ(result.status, RectifyStatus::kOk);
  EXPECT_NEAR(std::remainder(result.origin_m.x(), 0.6), 0, 1e-9);
  EXPECT_NEAR(std::remainder(result.origin_m.y(), 0.6), 0, 1e-9);
  EXPECT_LT((result.pixel_from_ground(result.ground_from_pixel({3.25, 7.5})) - Eigen::Vector2d(3.25, 7.5)).norm(),
            1e-9);
}

TEST(OrthoRectify, FineStructureDoesNotAlias) {
  // Stripes of 0.5 m under a result of 2 m a pixel: only their mean may remain.
  const Camera camera = kRectifiedCamera;
  const Attitude attitude{20, 4, -3};
  const auto stripes = [](const Eigen::Vector2d& p) {
    return 128 + 120 * std::sin(p.x() * 2 * std::numbers::pi / 0.53);
  };
  const cv::Mat frame = render(camera, attitude, 60, stripes);
  RectifyOptions options;
  options.gsd_m = 2;
  const RectifiedFrame result = ortho_rectify(frame, camera, attitude, 60, options);
  ASSERT_EQ(result.status, RectifyStatus::kOk);
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(result.gray, mean, deviation, result.valid);
  EXPECT_NEAR(mean[0], 128, 2);
  EXPECT_LT(deviation[0], 8);  // the stripes themselves have 85
}

TEST(OrthoRectify, SizeIsBounded) {
  const Camera camera = kRectifiedCamera;
  const cv::Mat frame(360, 480, CV_8UC1, cv::Scalar(100));
  RectifyOptions options;
  options.gsd_m = 0.001;
  options.max_size_px = 300;
  const RectifiedFrame cut = ortho_rectify(frame, camera, {}, 1000, options);
  ASSERT_EQ(cut.status, RectifyStatus::kOk);
  EXPECT_EQ(cut.gray.size(), cv::Size(300, 300));
  EXPECT_TRUE(cut.cut);
  // Near the horizon only the ground within max_off_nadir_deg is laid out.
  options.gsd_m = 1;
  options.max_size_px = 4096;
  const RectifiedFrame ahead = ortho_rectify(frame, camera, {0, 75, 0}, 100, options);
  ASSERT_EQ(ahead.status, RectifyStatus::kOk);
  EXPECT_TRUE(ahead.cut);
  EXPECT_LE(ahead.origin_m.y(), 100 * std::tan(65 * std::numbers::pi / 180) + 1);
}

TEST(OrthoRectify, EveryInputHasAStatus) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  const Camera camera =
      distorted(kRectifiedCamera, DistortionModel::kBrownConrady, {-0.25, 0.08, 0.002, -0.001, -0.01});
  const cv::Mat frame(360, 480, CV_8UC1, cv::Scalar(100));
  EXPECT_EQ(ortho_rectify(frame, camera, {nan, 0, 0}, 100).status, RectifyStatus::kBadAttitude);
  EXPECT_EQ(ortho_rectify(frame, camera, {0, inf, 0}, 100).status, RectifyStatus::kBadAttitude);
  EXPECT_EQ(ortho_rectify(frame, camera, {0, 0, -inf}, 100).status, RectifyStatus::kBadAttitude);
  for (const double bad : {nan, inf, 0.0, -5.0, 1e300}) {
    EXPECT_EQ(ortho_rectify(frame, camera, {}, bad).status, RectifyStatus::kBadHeight);
  }
  EXPECT_EQ(ortho_rectify(frame, camera, {0, 180, 0}, 100).status, RectifyStatus::kNoGround);
  EXPECT_EQ(ortho_rectify(cv::Mat(), camera, {}, 100).status, RectifyStatus::kBadFrame);
  EXPECT_EQ(ortho_rectify(cv::Mat(360, 480, CV_8UC3), camera, {}, 100).status, RectifyStatus::kBadFrame);
  EXPECT_EQ(ortho_rectify(cv::Mat(360, 481, CV_8UC1), camera, {}, 100).status, RectifyStatus::kBadFrame);
  EXPECT_EQ(ortho_rectify(frame, Camera{}, {}, 100).status, RectifyStatus::kBadCamera);
  for (const double bad : {nan, 0.0, -1.0, inf}) {
    EXPECT_EQ(ortho_rectify(frame, camera, {}, 100, {.gsd_m = bad}).status, RectifyStatus::kBadOptions);
  }
  EXPECT_EQ(ortho_rectify(frame, camera, {}, 100, {.max_size_px = 0}).status, RectifyStatus::kBadOptions);
  const cv::Mat wide(1, 40000, CV_8UC1, cv::Scalar(0));
  EXPECT_EQ(ortho_rectify(wide, {40000, 1, 400, 400, 20000, 0.5}, {}, 100).status, RectifyStatus::kBadFrame);
}

TEST(OrthoRectify, NeverThrows) {
  Random random(seed_from_name("NeverThrows"));
  const cv::Mat frame(60, 80, CV_8UC1, cv::Scalar(100));
  const cv::Mat dot(1, 1, CV_8UC1, cv::Scalar(7));
  const RectifyOptions options{.gsd_m = 1, .max_size_px = 64, .max_off_nadir_deg = 65};
  for (int i = 0; i < 2000; ++i) {
    const auto wild = [&] { return std::ldexp(random.uniform(-1, 1), static_cast<int>(random.below(60)) - 20); };
    Camera camera{80, 60, std::abs(wild()) + 1e-3, std::abs(wild()) + 1e-3, wild(), wild()};
    camera.distortion_model = static_cast<DistortionModel>(random.below(3));
    for (double& coefficient : camera.distortion) coefficient = random.below(2) == 0 ? wild() * 1e-6 : 0;
    const Attitude attitude{wild(), wild(), wild()};
    const double agl_m = std::abs(wild());
    EXPECT_NO_THROW({
      const RectifiedFrame result = ortho_rectify(frame, camera, attitude, agl_m, options);
      EXPECT_EQ(result.gray.empty(), result.status != RectifyStatus::kOk);
      EXPECT_LE(result.gray.cols, 64);
      ortho_rectify(dot, resized_camera(camera, 1, 1), attitude, agl_m, options);
    });
  }
}

}  // namespace
}  // namespace pilotage
