#include "pilotage/match/frame_grid.h"

#include <algorithm>

#include "match/chip_scene.h"
#include "testing/features_of_image.h"
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/vision/features.h"

namespace pilotage {
namespace {

RectifiedFrame whole_frame(int width, int height) {
  RectifiedFrame frame;
  frame.status = RectifyStatus::kOk;
  frame.gray = testing::random_ground(width, height, 3);
  frame.valid = cv::Mat(height, width, CV_8UC1, cv::Scalar(255));
  return frame;
}

/// Whether a pixel's patch lies in the frame and is valid everywhere.
bool patch_is_valid(const RectifiedFrame& frame, int x, int y, int radius) {
  const cv::Rect patch(x - radius, y - radius, 2 * radius + 1, 2 * radius + 1);
  const cv::Rect whole({0, 0}, frame.valid.size());
  return (patch & whole) == patch && cv::countNonZero(frame.valid(patch)) == patch.area();
}

TEST(DescribeFrameGrid, DescriptorsAreThoseOfFeaturesAtTheSamePixels) {
  const RectifiedFrame frame = whole_frame(160, 131);
  for (const int bits : {128, 256, 512}) {
    for (const bool oriented : {false, true}) {
      FeatureOptions options;
      options.descriptor_bits = bits;
      options.oriented = oriented;
      const FeatureSet features = testing::features_of_image(frame.gray, options);
      const FrameGrid grid = describe_frame_grid(frame, options, 1);
      ASSERT_EQ(grid.points.descriptor_bytes, bits / 8);
      ASSERT_GT(features.size(), 50U);
      for (std::size_t i = 0; i < features.size(); ++i) {
        const Feature& feature = features.features[i];
        const std::int32_t at = grid.at(static_cast<int>(feature.x_px), static_cast<int>(feature.y_px));
        ASSERT_GE(at, 0);
        const auto point = static_cast<std::size_t>(at);
        EXPECT_EQ(grid.points.features[point].x_px, feature.x_px);
        EXPECT_EQ(grid.points.features[point].y_px, feature.y_px);
        EXPECT_EQ(grid.points.features[point].angle_deg, feature.angle_deg);
        EXPECT_TRUE(
            std::equal(features.descriptor(i), features.descriptor(i) + bits / 8, grid.points.descriptor(point)))
            << bits << (oriented ? " oriented" : " upright");
      }
    }
  }
}

TEST(DescribeFrameGrid, APointIsWhereItsPatchIsValid) {
  RectifiedFrame frame = whole_frame(150, 121);
  frame.valid(cv::Rect(70, 60, 1, 1)).setTo(0);
  frame.valid(cv::Rect(0, 0, 20, 9)).setTo(0);
  frame.gray.setTo(0, frame.valid == 0);
  const FeatureOptions options;
  for (const int step : {1, 2, 3}) {
    const FrameGrid grid = describe_frame_grid(frame, options, step);
    EXPECT_EQ(grid.columns, (150 + step - 1) / step);
    EXPECT_EQ(grid.rows, (121 + step - 1) / step);
    std::size_t count = 0;
    for (int row = 0; row < grid.rows; ++row) {
      for (int column = 0; column < grid.columns; ++column) {
        const std::int32_t at = grid.at(column, row);
        const bool valid = patch_is_valid(frame, column * step, row * step, patch_radius_px(options));
        ASSERT_EQ(at >= 0, valid) << column << " " << row << " step " << step;
        if (!valid) continue;
        EXPECT_EQ(static_cast<std::size_t>(at), count++);
        EXPECT_EQ(grid.points.features[static_cast<std::size_t>(at)].x_px, static_cast<float>(column * step) + 0.5F);
        EXPECT_EQ(grid.points.features[static_cast<std::size_t>(at)].y_px, static_cast<float>(row * step) + 0.5F);
      }
    }
    EXPECT_EQ(grid.points.size(), count);
    EXPECT_EQ(grid.points.descriptors.size(), count * 32);
  }
}

TEST(DescribeFrameGrid, PixelsThatAreNotValidChangeNothing) {
  RectifiedFrame frame = whole_frame(150, 121);
  frame.valid(cv::Rect(60, 0, 30, 40)).setTo(0);
  FeatureOptions options;
  options.oriented = true;
  frame.gray.setTo(0, frame.valid == 0);
  const FrameGrid dark = describe_frame_grid(frame, options);
  frame.gray.setTo(255, frame.valid == 0);
  const FrameGrid bright = describe_frame_grid(frame, options);
  EXPECT_GT(dark.points.size(), 100U);
  EXPECT_EQ(dark.points.descriptors, bright.points.descriptors);
}

TEST(DescribeFrameGrid, OutsideThereIsNoPoint) {
  const FrameGrid grid = describe_frame_grid(whole_frame(90, 80), {});
  EXPECT_EQ(grid.at(-1, 20), -1);
  EXPECT_EQ(grid.at(20, -1), -1);
  EXPECT_EQ(grid.at(grid.columns, 20), -1);
  EXPECT_EQ(grid.at(20, grid.rows), -1);
  EXPECT_GE(grid.at(grid.columns / 2, grid.rows / 2), 0);
}

TEST(DescribeFrameGrid, AFrameSmallerThanAPatchHasNoPoints) {
  for (const int size : {1, 5, 30}) {
    const FrameGrid grid = describe_frame_grid(whole_frame(size, size), {});
    EXPECT_EQ(grid.points.size(), 0U);
    EXPECT_TRUE(grid.points.descriptors.empty());
  }
}

TEST(DescribeFrameGrid, BadOptionsAreUsageErrors) {
  FeatureOptions options;
  options.descriptor_bits = 200;
  EXPECT_THROW(describe_frame_grid(whole_frame(90, 80), options), UsageError);
}

}  // namespace
}  // namespace pilotage
