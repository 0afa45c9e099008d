#include "pilotage/matchability/self_votes.h"

#include <bit>
#include <cmath>
#include <cstdlib>

#include "testing/matrix_over.h"
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"
#include "pilotage/geo/tile_groups.h"
#include "pilotage/raster/raster.h"

namespace pilotage {
namespace {

using testing::all_tiles;
using testing::matrix_over;

/// Blobs at random: corners that differ from each other.
cv::Mat random_ground(int width, int height, std::uint64_t seed) {
  Random random(seed);
  cv::Mat noise(height, width, CV_32F);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) noise.at<float>(y, x) = static_cast<float>(random.below(1000));
  }
  cv::GaussianBlur(noise, noise, {}, 2);
  cv::Mat gray;
  cv::normalize(noise, noise, 0, 255, cv::NORM_MINMAX);
  noise.convertTo(gray, CV_8U);
  return gray;
}

/// The same piece of ground again and again.
cv::Mat repeated_ground(int width, int height, int period, std::uint64_t seed) {
  const cv::Mat piece = random_ground(period, period, seed);
  cv::Mat ground(height, width, CV_8U);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) ground.at<std::uint8_t>(y, x) = piece.at<std::uint8_t>(y % period, x % period);
  }
  return ground;
}

GraySource source_of(const cv::Mat& gray) {
  Raster raster;
  raster.pixels = gray;
  raster.valid = cv::Mat(gray.size(), CV_8U, cv::Scalar(255));
  return gray_source_from(raster);
}

/// A histogram of every pair, smoothed by OpenCV.
double plain_noise(const FeatureSet& map, const std::vector<std::size_t>& voters) {
  constexpr int kReach = kVoteReach_px;
  cv::Mat votes = cv::Mat::zeros(2 * kReach + 1, 2 * kReach + 1, CV_32F);
  for (const std::size_t voter : voters) {
    for (std::size_t other = 0; other < map.size(); ++other) {
      const float dx = map.features[other].x_px - map.features[voter].x_px;
      const float dy = map.features[other].y_px - map.features[voter].y_px;
      if (std::abs(dx) > kReach || std::abs(dy) > kReach) continue;
      int bits = 0;
      for (int byte = 0; byte < map.descriptor_bytes; ++byte) {
        bits += std::popcount(static_cast<unsigned>(map.descriptor(voter)[byte] ^ map.descriptor(other)[byte]));
      }
      if (bits <= descriptor_of(map).lookalike_bits())
        ++votes.at<float>(kReach + static_cast<int>(dy), kReach + static_cast<int>(dx));
    }
  }
  cv::boxFilter(votes, votes, -1, {3, 3}, {-1, -1}, false, cv::BORDER_CONSTANT);
  cv::Mat far(votes.size(), CV_8U, cv::Scalar(255));
  far(cv::Rect(kReach - 5, kReach - 5, 11, 11)).setTo(0);
  cv::Scalar mean;
  cv::Scalar sigma;
  cv::meanStdDev(votes, mean, sigma, far);
  return sigma[0];
}

TEST(SelfVotes, EqualTheHistogramOfEveryPair) {
  const cv::Mat gray = random_ground(700, 1200, 1);  // several bands of rows
  const TileMatrix matrix = matrix_over(source_of(gray), 128, 96);
  const auto indices = all_tiles(matrix);
  const FeatureOptions options;
  const GraySource source = source_of(gray);
  const auto votes = count_self_votes(source, matrix, indices, options, 1);
  const FeatureSet map = extract_features_of_map(source, {{0, 0, gray.cols, gray.rows}}, options, 1);
  for (const std::int64_t index : indices) {
    const PixelWindow tile = matrix.tile_window(index % matrix.matrix_width(), index / matrix.matrix_width());
    std::vector<std::size_t> inside;
    for (std::size_t i = 0; i < map.size(); ++i) {
      const auto x = static_cast<double>(map.features[i].x_px - static_cast<float>(tile.col));
      const auto y = static_cast<double>(map.features[i].y_px - static_cast<float>(tile.row));
      if (x >= 0 && x < 128 && y >= 0 && y < 128) inside.push_back(i);
    }
    const SelfVotes& of_tile = votes[static_cast<std::size_t>(index)];
    EXPECT_EQ(of_tile.features, static_cast<std::int64_t>(inside.size())) << index;
    EXPECT_NEAR(of_tile.noise, plain_noise(map, inside), 1e-5) << index;
  }
}

TEST(SelfVotes, AreTheSameForAnyThreadsAndAnyOtherTiles) {
  const cv::Mat gray = random_ground(600, 900, 2);
  const TileMatrix matrix = matrix_over(source_of(gray), 160, 64);
  const GraySource source = source_of(gray);
  const auto indices = all_tiles(matrix);
  const auto one = count_self_votes(source, matrix, indices, {}, 1);
  const auto four = count_self_votes(source, matrix, indices, {}, 4);
  const std::vector<std::int64_t> few{indices.back(), 17, 3};
  const auto alone = count_self_votes(source, matrix, few, {}, 2);
  for (std::size_t i = 0; i < indices.size(); ++i) {
    EXPECT_EQ(one[i].features, four[i].features);
    EXPECT_EQ(one[i].noise, four[i].noise);
  }
  for (std::size_t i = 0; i < few.size(); ++i) {
    EXPECT_EQ(alone[i].features, one[static_cast<std::size_t>(few[i])].features);
    EXPECT_EQ(alone[i].noise, one[static_cast<std::size_t>(few[i])].noise);
  }
}

/// The ground comes again every fourth block of features, and so do the votes; across the border of two slabs as well.
/// One slab is done before the next is begun: what is kept of them does not grow with the width of the map.
TEST(SelfVotes, OfAWideMapAreCountedSlabBySlab) {
  constexpr int kPeriod_px = 4 * kFeatureBlockPx;
  const cv::Mat piece = random_ground(kPeriod_px, 900, 4);
  cv::Mat twice;
  cv::hconcat(piece, piece, twice);
  GraySource source = source_of(piece);
  source.width_px = kSlabWidth_px + 2 * kPeriod_px;
  bool next_slab = false;
  bool went_back = false;
  source.read = [&](const PixelWindow& window) {
    next_slab = next_slab || window.col > kSlabWidth_px + kFeatureBlockPx;
    went_back = went_back || (next_slab && window.col < kSlabWidth_px - 2 * kFeatureBlockPx);
    Raster raster;
    raster.pixels = twice(cv::Rect(static_cast<int>(window.col % kPeriod_px), static_cast<int>(window.row),
                                   window.width, window.height))
                        .clone();
    raster.valid = cv::Mat(raster.pixels.size(), CV_8U, cv::Scalar(255));
    return raster;
  };
  const TileMatrix matrix = matrix_over(source, 256, 128);
  constexpr std::int64_t kTilesPerPeriod = kPeriod_px / 128;
  constexpr std::int64_t kBorder = kSlabWidth_px / 128;
  std::vector<std::int64_t> indices;
  for (std::int64_t row = 0; row < matrix.matrix_height(); ++row) {
    for (std::int64_t column = kBorder - kTilesPerPeriod; column < kBorder + kTilesPerPeriod; ++column) {
      indices.push_back(matrix.index_of(column, row));
    }
  }
  const auto votes = count_self_votes(source, matrix, indices, {}, 1);
  EXPECT_TRUE(next_slab);
  EXPECT_FALSE(went_back);
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const std::size_t again = i % (2 * kTilesPerPeriod) < kTilesPerPeriod ? i + kTilesPerPeriod : i;
    EXPECT_GT(votes[i].features, 100);
    EXPECT_EQ(votes[i].features, votes[again].features) << indices[i];
    EXPECT_EQ(votes[i].noise, votes[again].noise) << indices[i];
  }
}

TEST(SelfVotes, RepeatedGroundIsNoisier) {
  const cv::Mat unique = random_ground(500, 500, 3);
  const cv::Mat repeated = repeated_ground(500, 500, 40, 3);
  const TileMatrix matrix = matrix_over(source_of(unique), 200, 100);
  const std::vector<std::int64_t> middle{4};
  const SelfVotes a = count_self_votes(source_of(unique), matrix, middle, {}, 1).front();
  const SelfVotes b = count_self_votes(source_of(repeated), matrix, middle, {}, 1).front();
  ASSERT_GT(a.features, 100);
  ASSERT_GT(b.features, 100);
  // Each feature of the repeated ground votes for eight wrong places of this reach, all of them for the same.
  EXPECT_GT(b.noise, 5 * a.noise);
}

TEST(SelfVotes, FlatGroundHasNoFeaturesAndNoNoise) {
  const cv::Mat flat(400, 400, CV_8U, cv::Scalar(90));
  const SelfVotes votes =
      count_self_votes(source_of(flat), matrix_over(source_of(flat), 200, 100), std::vector<std::int64_t>{0}, {})
          .front();
  EXPECT_EQ(votes.features, 0);
  EXPECT_TRUE(std::isnan(votes.noise));
}

TEST(SelfVotes, RefusesATileThatIsNotThere) {
  const cv::Mat flat(400, 400, CV_8U, cv::Scalar(90));
  const TileMatrix matrix = matrix_over(source_of(flat), 200, 100);
  EXPECT_THROW(count_self_votes(source_of(flat), matrix, std::vector<std::int64_t>{9}, {}), UsageError);
}

}  // namespace
}  // namespace pilotage
