#include "pilotage/vision/features.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <numeric>
#include <set>
#include <tuple>

#include "testing/features_of_image.h"
#include <gtest/gtest.h>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"
#include "pilotage/vision/brief_pattern.h"
#include "pilotage/vision/feature_descriptor.h"
#include "pilotage/vision/feature_detector.h"
#include "pilotage/vision/feature_octave.h"
#include "pilotage/vision/ground_pattern.h"

namespace pilotage {
namespace {

using testing::features_of_image;

/// Noise smoothed to blobs of a few pixels, contrast about ±60.
cv::Mat textured(int width, int height, std::uint64_t seed) {
  Random random(seed);
  cv::Mat noise(height, width, CV_32FC1);
  for (int row = 0; row < height; ++row) {
    for (int col = 0; col < width; ++col) noise.at<float>(row, col) = static_cast<float>(random.normal());
  }
  cv::GaussianBlur(noise, noise, cv::Size(), 1.5);
  cv::Mat gray;
  noise.convertTo(gray, CV_8U, 200, 128);
  return gray;
}

FeatureOptions with_descriptor(DescriptorPattern pattern, int bits, int octaves = 1) {
  FeatureOptions options;
  options.pattern = pattern;
  options.descriptor_bits = bits;
  options.octaves = octaves;
  return options;
}

/// Every descriptor on one octave, and some on several.
std::vector<FeatureOptions> all_kinds() {
  std::vector<FeatureOptions> kinds;
  for (const BinaryDescriptor& d : kBinaryDescriptors) kinds.push_back(with_descriptor(d.pattern, d.bits));
  kinds.push_back(with_descriptor(DescriptorPattern::kGround, 128, 3));
  kinds.push_back(with_descriptor(DescriptorPattern::kOrb, 256, 2));
  return kinds;
}

const std::vector<FeatureOptions> kAllKinds = all_kinds();

bool same(const FeatureSet& a, const FeatureSet& b) {
  if (a.size() != b.size() || a.descriptors != b.descriptors) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Feature& f = a.features[i];
    const Feature& g = b.features[i];
    if (f.x_px != g.x_px || f.y_px != g.y_px || f.octave != g.octave || f.response != g.response) {
      return false;
    }
  }
  return true;
}

TEST(Features, NoPatchTouchesTheBorderOrInvalidPixels) {
  const cv::Mat gray = textured(300, 240, seed_from_name("NoPatchTouches"));
  cv::Mat valid(gray.size(), CV_8UC1, cv::Scalar(255));
  valid(cv::Rect(100, 80, 30, 1)).setTo(0);
  valid.at<std::uint8_t>(200, 250) = 0;
  for (const FeatureOptions& options : kAllKinds) {
    const FeatureSet set = features_of_image(gray, options, valid);
    EXPECT_GT(set.size(), 100U);
    for (const Feature& feature : set.features) {
      const double scale = std::pow(options.scale_factor, feature.octave);
      const double reach = (descriptor_of(options).reach_px + 0.5) * scale - 1e-3;
      const double left = static_cast<double>(feature.x_px) - reach;
      const double top = static_cast<double>(feature.y_px) - reach;
      ASSERT_GE(left, -1e-3);
      ASSERT_GE(top, -1e-3);
      ASSERT_LE(left + 2 * reach, gray.cols + 1e-3);
      ASSERT_LE(top + 2 * reach, gray.rows + 1e-3);
      const cv::Rect patch(static_cast<int>(left), static_cast<int>(top), static_cast<int>(2 * reach),
                           static_cast<int>(2 * reach));
      ASSERT_EQ(cv::countNonZero(valid(patch)), patch.area()) << feature.x_px << " " << feature.y_px;
    }
  }
}

TEST(Features, ValuesUnderInvalidPixelsDoNotMatter) {
  cv::Mat gray = textured(200, 200, seed_from_name("ValuesUnderInvalid"));
  cv::Mat valid(gray.size(), CV_8UC1, cv::Scalar(255));
  const cv::Rect hole(90, 60, 20, 25);
  valid(hole).setTo(0);
  for (const FeatureOptions& options : kAllKinds) {
    gray(hole).setTo(0);
    const FeatureSet dark = features_of_image(gray, options, valid);
    gray(hole).setTo(255);
    EXPECT_TRUE(same(dark, features_of_image(gray, options, valid)));
  }
}

TEST(Features, DescriptorsDependOnThePatchAlone) {
  const cv::Mat gray = textured(120, 120, seed_from_name("DependOnThePatch"));
  const cv::Mat other = textured(120, 120, seed_from_name("SomethingElse"));
  const std::vector<Corner> corners{{60, 60, 1.0F}};
  for (const FeatureOptions& options : kAllKinds) {
    const int radius = descriptor_of(options).reach_px;
    cv::Mat mixed = other.clone();
    const cv::Rect patch(60 - radius, 60 - radius, 2 * radius + 1, 2 * radius + 1);
    gray(patch).copyTo(mixed(patch));
    EXPECT_EQ(describe_corners(gray, corners, descriptor_of(options)),
              describe_corners(mixed, corners, descriptor_of(options)));
  }
}

TEST(Features, SpreadEvenlyOverStrongAndFaintGround) {
  cv::Mat gray = textured(400, 200, seed_from_name("SpreadEvenly"));
  cv::Mat faint = gray(cv::Rect(200, 0, 200, 200));
  faint.convertTo(faint, CV_8U, 0.3, 90);
  FeatureOptions options;
  options.features_per_mpx = 5000;
  const FeatureSet set = features_of_image(gray, options);
  const auto left = std::count_if(set.features.begin(), set.features.end(),
                                  [](const Feature& feature) { return feature.x_px < 200; });
  EXPECT_LE(set.size(), 400U);
  EXPECT_GT(left, 130);
  EXPECT_GT(static_cast<std::ptrdiff_t>(set.size()) - left, 130);
  // Without the fall-back the faint half has next to nothing.
  options.min_fast_threshold = options.fast_threshold = 60;
  const FeatureSet strong = features_of_image(gray, options);
  EXPECT_EQ(std::count_if(strong.features.begin(), strong.features.end(),
                          [](const Feature& feature) { return feature.x_px >= 205; }),
            0);
}

TEST(Features, DensityIsHeld) {
  const cv::Mat gray = textured(532, 532, seed_from_name("DensityIsHeld"));
  for (const int octaves : {1, 3}) {
    for (const double density : {100.0, 3000.0, 8000.0}) {
      FeatureOptions options = with_descriptor(DescriptorPattern::kOrb, 256, octaves);
      options.features_per_mpx = density;
      const auto count = static_cast<double>(features_of_image(gray, options).size());
      const double most = density * 532 * 532 / 1e6;
      EXPECT_LE(count, most);
      EXPECT_GT(count, 0.7 * most - octaves) << density;  // borders are left out, more of them at coarse octaves
    }
  }
}

TEST(Features, OrderIsOctaveRowColumn) {
  const FeatureSet set = features_of_image(textured(300, 300, 3), with_descriptor(DescriptorPattern::kGround, 256, 3));
  const auto key = [](const Feature& f) { return std::tuple(f.octave, f.y_px, f.x_px); };
  EXPECT_TRUE(std::is_sorted(set.features.begin(), set.features.end(),
                             [&](const Feature& a, const Feature& b) { return key(a) < key(b); }));
  EXPECT_EQ(set.features.back().octave, 2);
  EXPECT_EQ(set.descriptors.size(), set.size() * 32);
}

TEST(Features, SmallOrFlatImagesHaveNone) {
  for (const FeatureOptions& options : kAllKinds) {
    EXPECT_EQ(features_of_image(cv::Mat(), options).size(), 0U);
    EXPECT_EQ(features_of_image(textured(1, 1, 1), options).size(), 0U);
    EXPECT_EQ(features_of_image(textured(500, 5, 1), options).size(), 0U);
    EXPECT_EQ(features_of_image(textured(32, 32, 1), options).size(), 0U);
    EXPECT_EQ(features_of_image(cv::Mat(200, 200, CV_8UC1, cv::Scalar(77)), options).size(), 0U);
    EXPECT_EQ(features_of_image(textured(200, 200, 1), options, cv::Mat::zeros(200, 200, CV_8UC1)).size(), 0U);
  }
}

TEST(Features, OrbIsOpenCvsPattern) {
  const cv::Mat gray = textured(200, 200, seed_from_name("UprightIsOrbs"));
  const FeatureSet set = features_of_image(gray, with_descriptor(DescriptorPattern::kOrb, 256));
  std::vector<cv::KeyPoint> keypoints;
  for (const Feature& feature : set.features) {
    keypoints.emplace_back(feature.x_px - 0.5F, feature.y_px - 0.5F, 31.0F, 0.0F, 0.0F, 0);
  }
  cv::Mat rows;
  cv::ORB::create(500, 1.2F, 8, 3)->compute(gray, keypoints, rows);
  ASSERT_EQ(static_cast<std::size_t>(rows.rows), set.size());
  EXPECT_TRUE(std::equal(set.descriptors.begin(), set.descriptors.end(), rows.datastart));
}

TEST(Features, BriefComparesTheDrawnPairs) {
  const cv::Mat gray = textured(150, 150, seed_from_name("BriefComparesPairs"));
  cv::Mat smooth;
  cv::GaussianBlur(gray, smooth, {7, 7}, 2);
  for (const int bits : {128, 512}) {
    const FeatureOptions options = with_descriptor(DescriptorPattern::kBrief, bits);
    const FeatureSet set = features_of_image(gray, options);
    const auto pattern = make_brief_pattern(bits, kBriefPatternSeed);
    ASSERT_GT(set.size(), 20U);
    EXPECT_EQ(set.descriptor_bytes * 8, bits);
    for (std::size_t i = 0; i < set.size(); ++i) {
      const int x = static_cast<int>(set.features[i].x_px);
      const int y = static_cast<int>(set.features[i].y_px);
      for (std::size_t bit = 0; bit < pattern.size(); ++bit) {
        const BriefPair& p = pattern[bit];
        const bool darker = smooth.at<std::uint8_t>(y + p.y1, x + p.x1) < smooth.at<std::uint8_t>(y + p.y2, x + p.x2);
        ASSERT_EQ((set.descriptor(i)[bit / 8] >> bit % 8 & 1) != 0, darker);
      }
    }
  }
}

// By hand: sums of 3 × 3 pixels, compared; shorter descriptors are the first tests of the longest.
TEST(Features, GroundComparesSumsOfNinePixels) {
  const cv::Mat gray = textured(150, 150, seed_from_name("GroundComparesSums"));
  const auto sum_at = [&](int x, int y) {
    int sum = 0;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) sum += gray.at<std::uint8_t>(y + dy, x + dx);
    }
    return sum;
  };
  for (const int bits : {64, 128, 256}) {
    const FeatureSet set = features_of_image(gray, with_descriptor(DescriptorPattern::kGround, bits));
    ASSERT_GT(set.size(), 20U);
    for (std::size_t i = 0; i < set.size(); ++i) {
      const int x = static_cast<int>(set.features[i].x_px);
      const int y = static_cast<int>(set.features[i].y_px);
      for (std::size_t bit = 0; bit < static_cast<std::size_t>(bits); ++bit) {
        const BriefPair& p = kGroundPattern[bit];
        const bool darker = sum_at(x + p.x1, y + p.y1) < sum_at(x + p.x2, y + p.y2);
        ASSERT_EQ((set.descriptor(i)[bit / 8] >> bit % 8 & 1) != 0, darker) << bit;
      }
    }
  }
}

TEST(GroundPattern, LiesInItsReachAndRepeatsNoTest) {
  std::set<std::array<int, 4>> seen;
  for (const BriefPair& p : kGroundPattern) {
    for (const int offset : {p.x1, p.y1, p.x2, p.y2}) {
      EXPECT_LE(std::abs(offset) + kGroundBoxRadiusPx,
                descriptor_of(DescriptorPattern::kGround, kGroundPatternTests).reach_px);
    }
    EXPECT_TRUE(seen.insert({p.x1, p.y1, p.x2, p.y2}).second);
    EXPECT_FALSE(seen.contains({p.x2, p.y2, p.x1, p.y1})) << "the same test the other way round";
  }
}

TEST(Features, RefusesBadOptionsAndMatrices) {
  const cv::Mat gray = textured(50, 50, 1);
  EXPECT_THROW(features_of_image(gray, with_descriptor(DescriptorPattern::kGround, 200)), UsageError);
  EXPECT_THROW(features_of_image(gray, with_descriptor(DescriptorPattern::kOrb, 128)), UsageError);
  FeatureOptions options;
  options.min_fast_threshold = 30;
  EXPECT_THROW(features_of_image(gray, options), UsageError);
  options = with_descriptor(DescriptorPattern::kGround, 256, 12);
  EXPECT_THROW(features_of_image(gray, options), UsageError);
  EXPECT_THROW(features_of_image(cv::Mat(50, 50, CV_8UC3), {}), UsageError);
}

TEST(Detector, HarrisAgreesWithOpenCv) {
  const cv::Mat gray = textured(60, 60, 5);
  cv::Mat response;
  cv::cornerHarris(gray, response, 7, 3, 0.04);
  for (int y = 10; y < 50; y += 3) {
    for (int x = 10; x < 50; x += 3) {
      // OpenCV divides a Sobel derivative by 4 instead of 8, which counts to the fourth power.
      const float expected = response.at<float>(y, x) / 16;
      EXPECT_NEAR(harris_response(gray, x, y), expected, 1e-4 * std::abs(expected) + 1e-12);
    }
  }
}

TEST(Octave, DoesNotDependOnTheCut) {
  const cv::Mat gray = textured(190, 170, 9);
  cv::Mat valid(gray.size(), CV_8UC1, cv::Scalar(255));
  valid(cv::Rect(60, 70, 9, 4)).setTo(0);
  for (const double scale : {1.2, 1.44, 1.5, 2.0, 3.375}) {
    const Octave whole = make_octave(gray, valid, 0, 0, scale);
    EXPECT_EQ(whole.gray.cols, static_cast<int>(190 / scale));
    for (const cv::Rect rect : {cv::Rect(0, 0, 190, 170), cv::Rect(13, 7, 101, 99), cv::Rect(50, 60, 40, 41)}) {
      const Octave piece = make_octave(gray(rect), valid(rect), rect.x, rect.y, scale);
      ASSERT_FALSE(piece.gray.empty());
      const cv::Rect at(static_cast<int>(piece.first_col), static_cast<int>(piece.first_row), piece.gray.cols,
                        piece.gray.rows);
      EXPECT_EQ(cv::norm(whole.gray(at), piece.gray, cv::NORM_INF), 0);
      EXPECT_EQ(cv::norm(whole.valid(at), piece.valid, cv::NORM_INF), 0);
      EXPECT_GE(static_cast<double>(piece.first_col) * scale, rect.x);
    }
    for (int row = 0; row < whole.gray.rows; ++row) {
      for (int col = 0; col < whole.gray.cols; ++col) {
        const cv::Rect covered(
            cv::Point(static_cast<int>(col * scale), static_cast<int>(row * scale)),
            cv::Point(static_cast<int>(std::ceil((col + 1) * scale)), static_cast<int>(std::ceil((row + 1) * scale))));
        const bool all_valid = cv::countNonZero(valid(covered)) == covered.area();
        ASSERT_EQ(whole.valid.at<std::uint8_t>(row, col) != 0, all_valid);
      }
    }
  }
  // At a whole factor it is the plain mean.
  const Octave half = make_octave(gray, {}, 0, 0, 2);
  EXPECT_NEAR(half.gray.at<std::uint8_t>(5, 8), cv::mean(gray(cv::Rect(16, 10, 2, 2)))[0], 0.5001);
}

TEST(BriefPattern, IsCalondersGaussian) {
  const auto pattern = make_brief_pattern(512, 1);
  ASSERT_EQ(pattern.size(), 512U);
  EXPECT_EQ(make_brief_pattern(512, 1), pattern);
  EXPECT_NE(make_brief_pattern(512, 2), pattern);
  double sum = 0;
  double sum2 = 0;
  for (const BriefPair& pair : pattern) {
    EXPECT_TRUE(pair.x1 != pair.x2 || pair.y1 != pair.y2);
    for (const int offset : {pair.x1, pair.y1, pair.x2, pair.y2}) {
      EXPECT_LE(std::abs(offset), 15);
      sum += offset;
      sum2 += offset * offset;
    }
  }
  EXPECT_NEAR(sum / 2048, 0, 0.6);
  EXPECT_NEAR(std::sqrt(sum2 / 2048), 31.0 / 5, 0.5);
}

/// A source in memory that remembers which windows were read.
struct CountingSource {
  GraySource source;
  std::shared_ptr<std::atomic<int>> reads = std::make_shared<std::atomic<int>>(0);

  CountingSource(const cv::Mat& gray, const cv::Mat& valid) {
    source = gray_source_from({gray, valid, GeoTransform{}});
    source.read = [inner = source.read, count = reads](const PixelWindow& window) {
      ++*count;
      return inner(window);
    };
  }
};

TEST(MapFeatures, ThreadsAndWindowsDoNotChangeThem) {
  const cv::Mat gray = textured(1300, 1100, seed_from_name("ThreadsAndWindows"));
  cv::Mat valid(gray.size(), CV_8UC1, cv::Scalar(255));
  valid(cv::Rect(500, 500, 40, 40)).setTo(0);
  for (const FeatureOptions& options : {FeatureOptions(), with_descriptor(DescriptorPattern::kOrb, 256, 3)}) {
    const CountingSource all(gray, valid);
    const FeatureSet whole = extract_features_of_map(all.source, {{0, 0, 1300, 1100}}, options, 1);
    EXPECT_EQ(*all.reads, 9);
    EXPECT_GT(whole.size(), 2000U);
    EXPECT_TRUE(same(whole, extract_features_of_map(all.source, {{-5, -5, 5000, 5000}}, options, 4)));

    std::set<std::tuple<int, float, float>> places;
    for (const Feature& f : whole.features) {
      EXPECT_TRUE(places.emplace(f.octave, f.x_px, f.y_px).second) << "twice: " << f.x_px << " " << f.y_px;
    }

    const CountingSource some(gray, valid);
    const std::vector<PixelWindow> windows{{100, 100, 200, 150}, {400, 90, 200, 100},  {250, 120, 100, 100},
                                           {1290, 1090, 50, 50}, {2000, 2000, 10, 10}, {10, 10, 0, 5}};
    const FeatureSet part = extract_features_of_map(some.source, windows, options, 2);
    EXPECT_EQ(*some.reads, 3);
    FeatureSet expected;
    for (std::size_t i = 0; i < whole.size(); ++i) {
      const Feature& f = whole.features[i];
      const bool wanted = std::any_of(windows.begin(), windows.end(), [&](const PixelWindow& w) {
        return f.x_px >= static_cast<float>(w.col) && f.x_px < static_cast<float>(w.col + w.width) &&
               f.y_px >= static_cast<float>(w.row) && f.y_px < static_cast<float>(w.row + w.height);
      });
      if (!wanted) continue;
      expected.features.push_back(f);
      expected.descriptors.insert(expected.descriptors.end(), whole.descriptor(i),
                                  whole.descriptor(i) + whole.descriptor_bytes);
    }
    EXPECT_GT(part.size(), 50U);
    EXPECT_TRUE(same(part, expected));
  }
}

TEST(MapFeatures, BlocksLeaveNoSeam) {
  // Ground in the strips along the blocks' borders has as many features as elsewhere, and the descriptors of the whole
  // image.
  const cv::Mat gray = textured(1100, 600, seed_from_name("BlocksLeaveNoSeam"));
  const FeatureSet set = extract_features_of_map(
      gray_source_from({gray, cv::Mat(gray.size(), CV_8UC1, cv::Scalar(255)), {}}), {{0, 0, 1100, 600}}, {}, 2);
  const auto count_in = [&](float from, float to) {
    return std::count_if(set.features.begin(), set.features.end(),
                         [&](const Feature& f) { return f.x_px >= from && f.x_px < to; });
  };
  EXPECT_NEAR(static_cast<double>(count_in(492, 532)), static_cast<double>(count_in(200, 240)), 80);
  EXPECT_GT(count_in(508, 516), 20);
  std::vector<Corner> corners;
  for (const Feature& f : set.features) corners.push_back({static_cast<int>(f.x_px), static_cast<int>(f.y_px), 0});
  EXPECT_EQ(set.descriptors, describe_corners(gray, corners, descriptor_of(set)));
}

TEST(MapFeatures, ErrorsAndInterruptionsComeThrough) {
  GraySource source = gray_source_from({textured(600, 600, 1), cv::Mat(600, 600, CV_8UC1, cv::Scalar(255)), {}});
  EXPECT_THROW(extract_features_of_map(source, {{0, 0, 600, 600}}, {}, 2,
                                       [](std::string_view, std::int64_t, std::int64_t) { return false; }),
               Interrupted);
  std::int64_t last = 0;
  extract_features_of_map(source, {{0, 0, 600, 600}}, {}, 2,
                          [&](std::string_view, std::int64_t done, std::int64_t total) {
                            EXPECT_EQ(done, last + 1);
                            EXPECT_EQ(total, 4);
                            last = done;
                            return true;
                          });
  EXPECT_EQ(last, 4);
  EXPECT_THROW(extract_features_of_map(source, {{0, 0, -1, 5}}, {}), UsageError);
  source.read = [](const PixelWindow&) -> Raster { throw DataError("unreadable"); };
  EXPECT_THROW(extract_features_of_map(source, {{0, 0, 600, 600}}, {}), DataError);
  source.depth = CV_16U;
  EXPECT_THROW(extract_features_of_map(source, {{0, 0, 600, 600}}, {}), UsageError);
}

}  // namespace
}  // namespace pilotage
