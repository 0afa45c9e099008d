#include "pilotage/compare/descriptor_method.h"

#include <algorithm>
#include <utility>

// As in surf_features.cc: headers alone.
#include <dlib/assert.h>
#undef DLIB_USE_BLAS
#undef DLIB_USE_LAPACK
#define DLIB_TEST_FOR_ODR_VIOLATIONS_H_
#include "compare/texture.h"
#include "testing/features_of_image.h"
#include <dlib/image_keypoint/surf.h>
#include <dlib/opencv/cv_image.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/compare/compare_options.h"
#include "pilotage/vision/features.h"

namespace pilotage {
namespace {

const std::vector<DescriptorMethod> kAllMethods = CompareOptions{}.methods;

cv::Mat everywhere(const cv::Mat& gray) {
  return {gray.size(), CV_8UC1, cv::Scalar(255)};
}

TEST(DescriptorMethod, EveryMethodFindsTheFeaturesItIsAskedForWithinTheMask) {
  const cv::Mat gray = testing::texture(500, 420, 1);
  cv::Mat allowed = everywhere(gray);
  allowed.colRange(0, 250).setTo(0);
  for (const DescriptorMethod method : kAllMethods) {
    SCOPED_TRACE(descriptor_method_title(method));
    const DescribedImage found = describe_image(method, gray, allowed, 100);
    EXPECT_GE(found.points_px.size(), 40U);
    EXPECT_LE(found.points_px.size(), 130U);  // ours: whole numbers in each cell
    ASSERT_EQ(found.descriptors.rows, static_cast<int>(found.points_px.size()));
    for (const Eigen::Vector2d& point : found.points_px) {
      EXPECT_GE(point.x(), 249.5);
      EXPECT_LE(point.x(), 500);
      EXPECT_GE(point.y(), 0);
      EXPECT_LE(point.y(), 420);
    }
  }
}

TEST(DescriptorMethod, DescriptorsHaveTheLengthTheirNameSays) {
  const cv::Mat gray = testing::texture(300, 300, 2);
  const auto descriptors = [&](DescriptorMethod method) {
    return describe_image(method, gray, everywhere(gray), 50).descriptors;
  };
  EXPECT_EQ(descriptors(DescriptorMethod::kOrb).cols, 32);
  EXPECT_EQ(descriptors(DescriptorMethod::kGround64).cols, 8);
  EXPECT_EQ(descriptors(DescriptorMethod::kGround128).cols, 16);
  EXPECT_EQ(descriptors(DescriptorMethod::kGround256).cols, 32);
  EXPECT_EQ(descriptors(DescriptorMethod::kOrb256).cols, 32);
  EXPECT_EQ(descriptors(DescriptorMethod::kBrief128).cols, 16);
  EXPECT_EQ(descriptors(DescriptorMethod::kBrief512).cols, 64);
  EXPECT_EQ(descriptors(DescriptorMethod::kBrief512).type(), CV_8UC1);
  EXPECT_EQ(descriptors(DescriptorMethod::kSift).cols, 128);
  EXPECT_EQ(descriptors(DescriptorMethod::kSurf).cols, 64);
  EXPECT_EQ(descriptors(DescriptorMethod::kSurf).type(), CV_32FC1);
}

TEST(DescriptorMethod, BinaryOnesAreThoseOfTheMap) {
  const cv::Mat gray = testing::texture(260, 240, 3);
  for (const auto& [method, pattern, bits] :
       {std::tuple{DescriptorMethod::kGround64, DescriptorPattern::kGround, 64},
        std::tuple{DescriptorMethod::kGround128, DescriptorPattern::kGround, 128},
        std::tuple{DescriptorMethod::kGround256, DescriptorPattern::kGround, 256},
        std::tuple{DescriptorMethod::kOrb256, DescriptorPattern::kOrb, 256},
        std::tuple{DescriptorMethod::kBrief128, DescriptorPattern::kBrief, 128},
        std::tuple{DescriptorMethod::kBrief512, DescriptorPattern::kBrief, 512}}) {
    SCOPED_TRACE(descriptor_method_title(method));
    FeatureOptions options;
    options.pattern = pattern;
    options.descriptor_bits = bits;
    const int margin = descriptor_of(options).reach_px;
    const int area_px = (gray.cols - 2 * margin) * (gray.rows - 2 * margin);
    options.features_per_mpx = 5000;
    const FeatureSet expected = testing::features_of_image(gray, options);
    const DescribedImage found = describe_image(method, gray, everywhere(gray), static_cast<int>(area_px * 0.005));
    ASSERT_NEAR(static_cast<double>(found.points_px.size()), static_cast<double>(expected.size()), 10);
    // Budgets are whole numbers, so a cell may keep one corner more or less; corners of both have equal descriptors.
    std::size_t common = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      for (std::size_t k = 0; k < found.points_px.size(); ++k) {
        if (found.points_px[k].x() != expected.features[i].x_px ||
            found.points_px[k].y() != expected.features[i].y_px) {
          continue;
        }
        ++common;
        EXPECT_TRUE(std::equal(expected.descriptor(i), expected.descriptor(i) + bits / 8,
                               found.descriptors.ptr<std::uint8_t>(static_cast<int>(k))));
      }
    }
    EXPECT_GE(common, expected.size() * 9 / 10);
  }
}

TEST(DescriptorMethod, SurfIsThatOfDlib) {
  const cv::Mat gray = testing::texture(400, 400, 4);
  std::vector<dlib::surf_point> expected = dlib::get_surf_points(dlib::cv_image<unsigned char>(gray), 100000, 1.0);
  std::sort(expected.begin(), expected.end(), [](const dlib::surf_point& a, const dlib::surf_point& b) {
    if (a.p.score != b.p.score) return a.p.score > b.p.score;
    return std::pair(a.p.center.y(), a.p.center.x()) < std::pair(b.p.center.y(), b.p.center.x());
  });
  const DescribedImage found = describe_image(DescriptorMethod::kSurf, gray, everywhere(gray), 100000);
  ASSERT_GE(expected.size(), 50U);
  ASSERT_EQ(found.points_px.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(found.points_px[i].x(), expected[i].p.center.x() + 0.5);
    EXPECT_EQ(found.points_px[i].y(), expected[i].p.center.y() + 0.5);
    for (int k = 0; k < 64; ++k) {
      EXPECT_FLOAT_EQ(found.descriptors.at<float>(static_cast<int>(i), k), static_cast<float>(expected[i].des(k)));
    }
  }
}

TEST(DescriptorMethod, ImagesWithoutRoomOrTextureHaveNone) {
  for (const DescriptorMethod method : kAllMethods) {
    SCOPED_TRACE(descriptor_method_title(method));
    const cv::Mat flat(300, 300, CV_8UC1, cv::Scalar(90));
    EXPECT_TRUE(describe_image(method, flat, everywhere(flat), 100).points_px.empty());
    for (const int side : {1, 20, 64}) {
      const cv::Mat small = testing::texture(side, side, 5);
      const DescribedImage found = describe_image(method, small, everywhere(small), 100);
      EXPECT_EQ(found.descriptors.rows, static_cast<int>(found.points_px.size()));
    }
    const cv::Mat gray = testing::texture(200, 200, 6);
    EXPECT_TRUE(describe_image(method, gray, cv::Mat::zeros(gray.size(), CV_8UC1), 100).points_px.empty());
  }
}

TEST(DescriptorMethod, RefusesOtherImages) {
  const cv::Mat gray = testing::texture(100, 100, 7);
  EXPECT_THROW(describe_image(DescriptorMethod::kOrb, cv::Mat(), everywhere(gray), 10), UsageError);
  EXPECT_THROW(describe_image(DescriptorMethod::kOrb, gray, cv::Mat(), 10), UsageError);
  EXPECT_THROW(describe_image(DescriptorMethod::kOrb, cv::Mat(gray.size(), CV_32F), everywhere(gray), 10), UsageError);
  EXPECT_THROW(describe_image(DescriptorMethod::kOrb, gray, everywhere(gray), 0), UsageError);
}

}  // namespace
}  // namespace pilotage
