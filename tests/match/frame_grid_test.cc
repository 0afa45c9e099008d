#include "pilotage/match/frame_grid.h"

#include <algorithm>

#include "match/chip_scene.h"
#include "testing/features_of_image.h"
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"
#include "pilotage/vision/features.h"

namespace pilotage {
namespace {

constexpr int kDefaultReachPx = find_descriptor(kDefaultDescriptorPattern, kDefaultDescriptorBits)->reach_px;

RectifiedFrame whole_frame(int width, int height) {
  RectifiedFrame frame;
  frame.status = RectifyStatus::kOk;
  frame.gray = testing::random_ground(width, height, 3);
  frame.valid = cv::Mat(height, width, CV_8UC1, cv::Scalar(255));
  return frame;
}

/// Whether everything within a radius lies in the frame and is valid.
bool patch_is_valid(const RectifiedFrame& frame, int x, int y, int radius) {
  const cv::Rect patch(x - radius, y - radius, 2 * radius + 1, 2 * radius + 1);
  const cv::Rect whole({0, 0}, frame.valid.size());
  return (patch & whole) == patch && cv::countNonZero(frame.valid(patch)) == patch.area();
}

TEST(DescribeFrameGrid, DescriptorsAreThoseOfFeaturesAtTheSamePixels) {
  const RectifiedFrame frame = whole_frame(160, 131);
  for (const BinaryDescriptor& descriptor : kBinaryDescriptors) {
    FeatureOptions options;
    options.pattern = descriptor.pattern;
    options.descriptor_bits = descriptor.bits;
    const FeatureSet features = testing::features_of_image(frame.gray, options);
    const FrameGrid grid = describe_frame_grid(frame, options, 1);
    ASSERT_EQ(&descriptor_of(grid.points), &descriptor);
    ASSERT_GT(features.size(), 50U);
    for (std::size_t i = 0; i < features.size(); ++i) {
      const Feature& feature = features.features[i];
      const std::int32_t at = grid.at(static_cast<int>(feature.x_px), static_cast<int>(feature.y_px));
      ASSERT_GE(at, 0);
      const auto point = static_cast<std::size_t>(at);
      EXPECT_EQ(grid.points.features[point].x_px, feature.x_px);
      EXPECT_EQ(grid.points.features[point].y_px, feature.y_px);
      EXPECT_TRUE(std::equal(features.descriptor(i), features.descriptor(i) + descriptor.bytes(),
                             grid.points.descriptor(point)))
          << descriptor_name(descriptor);
    }
  }
}

TEST(DescribeContinuedGrid, PointsAreThoseOfTheFrameItself) {
  RectifiedFrame frame = whole_frame(150, 121);
  frame.gsd_m = 0.5;
  frame.origin_m = {-40, 30};
  frame.valid(cv::Rect(70, 60, 1, 1)).setTo(0);
  frame.valid(cv::Rect(0, 0, 40, 29)).setTo(0);
  frame.gray.setTo(0, frame.valid == 0);
  const cv::Mat gray = frame.gray.clone();
  const RectifiedFrame wide = continued_frame(frame, {});
  EXPECT_EQ(cv::norm(gray, frame.gray), 0);
  EXPECT_EQ(cv::countNonZero(wide.valid), cv::countNonZero(frame.valid));
  const FrameGrid own = describe_frame_grid(frame, {}, 1);
  const FrameGrid continued = describe_continued_grid(wide, {}, 1);
  ASSERT_EQ(own.points.size(), continued.points.size());
  ASSERT_GT(own.points.size(), 1000U);
  EXPECT_EQ(own.points.descriptors, continued.points.descriptors);
  for (std::size_t i = 0; i < own.points.size(); ++i) {
    const auto ground_m = [&](const RectifiedFrame& shown, const Feature& point) {
      return shown.ground_from_pixel({static_cast<double>(point.x_px), static_cast<double>(point.y_px)});
    };
    EXPECT_EQ(ground_m(frame, own.points.features[i]), ground_m(wide, continued.points.features[i]));
  }
}

TEST(DescribeFrameGrid, APointIsWhereItLiesWellInside) {
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
        const bool valid = patch_is_valid(frame, column * step, row * step, kLeastInsidePx);
        ASSERT_EQ(at >= 0, valid) << column << " " << row << " step " << step;
        if (!valid) continue;
        EXPECT_EQ(static_cast<std::size_t>(at), count++);
        EXPECT_EQ(grid.points.features[static_cast<std::size_t>(at)].x_px, static_cast<float>(column * step) + 0.5F);
        EXPECT_EQ(grid.points.features[static_cast<std::size_t>(at)].y_px, static_cast<float>(row * step) + 0.5F);
      }
    }
    EXPECT_EQ(grid.points.size(), count);
    EXPECT_EQ(grid.points.descriptors.size(), count * static_cast<std::size_t>(grid.points.descriptor_bytes));
  }
}

TEST(DescribeFrameGrid, PixelsThatAreNotValidChangeNothing) {
  RectifiedFrame frame = whole_frame(150, 121);
  frame.valid(cv::Rect(60, 0, 30, 40)).setTo(0);
  const FeatureOptions options;
  frame.gray.setTo(0, frame.valid == 0);
  const FrameGrid dark = describe_frame_grid(frame, options);
  frame.gray.setTo(255, frame.valid == 0);
  const FrameGrid bright = describe_frame_grid(frame, options);
  EXPECT_GT(dark.points.size(), 100U);
  EXPECT_EQ(dark.points.descriptors, bright.points.descriptors);
}

// Beyond what is valid the picture goes on with its nearest pixel: by hand for a frame that ends at its edges.
TEST(DescribeFrameGrid, APatchBeyondTheEdgeIsContinued) {
  const RectifiedFrame frame = whole_frame(90, 70);
  RectifiedFrame wider = frame;
  const int border_px = kDefaultReachPx;
  cv::copyMakeBorder(frame.gray, wider.gray, border_px, border_px, border_px, border_px, cv::BORDER_REPLICATE);
  wider.valid = cv::Mat(wider.gray.size(), CV_8UC1, cv::Scalar(255));
  const FrameGrid grid = describe_frame_grid(frame, {}, 1);
  const FrameGrid whole = describe_frame_grid(wider, {}, 1);
  for (const auto& [x, y] : {std::pair{kLeastInsidePx, kLeastInsidePx}, {84, 7}, {40, 64}, {6, 60}, {45, 35}}) {
    ASSERT_GE(grid.at(x, y), 0);
    const std::uint8_t* const at_edge = grid.points.descriptor(static_cast<std::size_t>(grid.at(x, y)));
    const std::uint8_t* const inside =
        whole.points.descriptor(static_cast<std::size_t>(whole.at(x + border_px, y + border_px)));
    EXPECT_TRUE(std::equal(at_edge, at_edge + grid.points.descriptor_bytes, inside)) << x << " " << y;
  }
}

TEST(DescribeFrameGrid, OutsideThereIsNoPoint) {
  const FrameGrid grid = describe_frame_grid(whole_frame(90, 80), {});
  EXPECT_EQ(grid.at(-1, 20), -1);
  EXPECT_EQ(grid.at(20, -1), -1);
  EXPECT_EQ(grid.at(grid.columns, 20), -1);
  EXPECT_EQ(grid.at(20, grid.rows), -1);
  EXPECT_GE(grid.at(grid.columns / 2, grid.rows / 2), 0);
}

TEST(DescribeFrameGrid, AFrameOfAFewPixelsHasNoPoints) {
  for (const int size : {1, 5, 10}) {
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
