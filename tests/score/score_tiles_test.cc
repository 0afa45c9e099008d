#include "pilotage/score/score_tiles.h"

#include <cmath>
#include <cstring>
#include <map>
#include <string>

#include "testing/error_of.h"
#include "testing/matrix_over.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"
#include "pilotage/correlation/correlation_peaks.h"
#include "pilotage/correlation/fft_correlation.h"
#include "pilotage/ground/tile_table.h"
#include "pilotage/score/gray_statistics.h"

namespace pilotage {
namespace {

using testing::all_tiles;
using testing::error_of;

/// Coarse structure and grain, around 110 gray levels.
Raster ground(int rows, int cols, std::string_view name) {
  Random random(seed_from_name(name));
  cv::Mat noise(rows, cols, CV_32F);
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) noise.at<float>(row, col) = static_cast<float>(random.normal());
  }
  cv::Mat coarse;
  cv::GaussianBlur(noise, coarse, {0, 0}, 4);
  Raster raster;
  cv::Mat(110 + 150 * coarse + 9 * noise).convertTo(raster.pixels, CV_8U);
  raster.valid = cv::Mat(rows, cols, CV_8U, cv::Scalar(255));
  return raster;
}

struct Request : ScoreOptions {
  int tile_size_px = 0;
  int stride_px = 0;
  int search_radius_px = 0;
};

Request options_of(int tile_size_px, int stride_px, int search_radius_px) {
  Request request;
  request.tile_size_px = tile_size_px;
  request.stride_px = stride_px;
  request.search_radius_px = search_radius_px;
  return request;
}

TileMatrix matrix_of(const GraySource& source, const Request& request) {
  return testing::matrix_over(source, request.tile_size_px, request.stride_px);
}

/// The tiles named; none named: all of them.
std::vector<TileScores> score(const Raster& raster, const Request& request, std::vector<std::int64_t> tiles = {},
                              int threads = 1) {
  const GraySource source = gray_source_from(raster);
  const TileMatrix matrix = matrix_of(source, request);
  if (tiles.empty()) tiles = all_tiles(matrix);
  return score_tiles(source, matrix, request.search_radius_px, tiles, request, 5, threads);
}

/// All numbers of the scores, for bit-wise comparison.
std::vector<std::uint64_t> bits_of(const std::vector<TileScores>& scores) {
  std::vector<std::uint64_t> bits;
  for (const TileScores& tile : scores) {
    bits.push_back(static_cast<std::uint64_t>(tile.status));
    for (const Measure& measure : measures()) {
      const double value = measure.get(tile);
      std::uint64_t word = 0;
      std::memcpy(&word, &value, sizeof(word));
      bits.push_back(std::isnan(value) ? 0 : word);
    }
  }
  return bits;
}

/// Every tile's numbers against the plain way: direct sums and cv::matchTemplate over its search area.
void expect_as_plain(const Raster& raster, const Request& options) {
  const GraySource source = gray_source_from(raster);
  const TileMatrix matrix = matrix_of(source, options);
  const std::vector<TileScores> scores = score(raster, options);
  ASSERT_EQ(scores.size(), static_cast<std::size_t>(matrix.tile_count()));
  cv::Mat map;
  raster.pixels.convertTo(map, CV_32F);
  for (std::size_t i = 0; i < scores.size(); ++i) {
    const TileScores& tile = scores[i];
    const TileCell cell = matrix.cell_of(static_cast<std::int64_t>(i));
    const PixelWindow window = matrix.tile_window(cell);
    const PixelWindow area = matrix.search_window(cell, options.search_radius_px);
    const cv::Rect rect(static_cast<int>(window.col), static_cast<int>(window.row), window.width, window.height);
    const cv::Rect around(static_cast<int>(area.col), static_cast<int>(area.row), area.width, area.height);
    const GrayStatistics statistics = gray_statistics(raster.pixels(rect), raster.valid(rect));
    EXPECT_NEAR(tile.gray_variance, statistics.gray_variance, 1e-9 * statistics.gray_variance);
    EXPECT_NEAR(tile.frieden_entropy, statistics.frieden_entropy, 1e-9 * statistics.frieden_entropy);
    EXPECT_NEAR(tile.frieden_deficit, statistics.frieden_deficit, 1e-9 * std::abs(statistics.frieden_deficit));

    cv::Mat surface;
    cv::matchTemplate(map(around), map(rect), surface, cv::TM_CCOEFF_NORMED);
    const CorrelationPeaks peaks = correlation_peaks(surface, rect.tl() - around.tl(), options.tile_size_px);
    EXPECT_NEAR(tile.clean.peak, 1, 1e-5);
    EXPECT_NEAR(tile.clean.rival, peaks.rival, 1e-4) << "tile " << cell.column << ", " << cell.row;
    EXPECT_NEAR(tile.clean.margin, peaks.margin, 1e-4);
    EXPECT_NEAR(tile.clean.psr, peaks.psr, 1e-2 * peaks.psr);
    EXPECT_NEAR(tile.clean.half_width_px, peaks.half_width_px, 0.1);
  }
}

TEST(ScoreTiles, AgreesWithThePlainWay) {
  Request options = options_of(32, 8, 16);  // four blocks a side
  options.measures = {ScoreMeasure::kGrayVariance, ScoreMeasure::kFriedenEntropy, ScoreMeasure::kUniqueness};
  expect_as_plain(ground(120, 150, "plain"), options);
}

TEST(ScoreTiles, AgreesWithThePlainWayForOddSizes) {
  for (const auto& [tile, stride, radius] : {std::tuple(30, 10, 7), std::tuple(25, 11, 9), std::tuple(16, 16, 40),
                                             std::tuple(20, 37, 5), std::tuple(36, 2, 3)}) {
    Request options = options_of(tile, stride, radius);
    options.measures = {ScoreMeasure::kGrayVariance, ScoreMeasure::kFriedenEntropy, ScoreMeasure::kUniqueness};
    expect_as_plain(ground(61, 77, "odd sizes"), options);
  }
}

/// More columns and rows than one piece of work holds.
TEST(ScoreTiles, PiecesFitTogether) {
  Request options = options_of(16, 8, 8);
  options.measures = {ScoreMeasure::kGrayVariance, ScoreMeasure::kFriedenEntropy, ScoreMeasure::kUniqueness};
  expect_as_plain(ground(90, 700, "pieces"), options);
}

/// Ground as smooth as an orthophoto, `sigma_px` the scale of its finest structure.
Raster smooth_ground(int rows, int cols, double sigma_px, std::string_view name) {
  Random random(seed_from_name(name));
  cv::Mat noise(rows, cols, CV_32F);
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) noise.at<float>(row, col) = static_cast<float>(random.normal());
  }
  cv::Mat fine;
  cv::Mat coarse;
  cv::GaussianBlur(noise, fine, {0, 0}, sigma_px);
  cv::GaussianBlur(noise, coarse, {0, 0}, 6 * sigma_px);
  Raster raster;
  cv::Mat(110 + 60 * sigma_px * fine + 120 * 6 * sigma_px * coarse / 4).convertTo(raster.pixels, CV_8U);
  raster.valid = cv::Mat(rows, cols, CV_8U, cv::Scalar(255));
  return raster;
}

/// Surfaces of every second and every fourth lag against those of every lag; the bounds are those of
/// docs/methods/uniqueness.md.
TEST(ScoreTiles, LatticesOfLagsAgreeWithEveryLag) {
  for (const double sigma_px : {1.0, 2.0}) {  // a step of 2, of 4
    const Raster raster = smooth_ground(300, 320, sigma_px, "lattice");
    Request options = options_of(64, 32, 100);
    options.measures = {ScoreMeasure::kUniqueness, ScoreMeasure::kDegraded};
    const std::vector<TileScores> sparse = score(raster, options, {}, 2);
    options.every_lag = true;
    const std::vector<TileScores> all = score(raster, options, {}, 2);
    EXPECT_NE(bits_of(sparse), bits_of(all)) << "no lattice was used";
    int equal = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      EXPECT_NEAR(sparse[i].clean.peak, all[i].clean.peak, 1e-4);
      EXPECT_NEAR(sparse[i].clean.rival, all[i].clean.rival, 0.02);
      EXPECT_NEAR(sparse[i].clean.half_width_px, all[i].clean.half_width_px, 0.1);
      EXPECT_NEAR(sparse[i].clean.psr, all[i].clean.psr, 0.03 * all[i].clean.psr);
      EXPECT_EQ(sparse[i].degraded.rival, all[i].degraded.rival) << "degraded copies have every lag";
      equal += std::abs(sparse[i].clean.rival - all[i].clean.rival) < 1e-4;
    }
    EXPECT_GT(equal, static_cast<int>(all.size()) * 9 / 10) << sigma_px;
  }
}

/// On a smooth map a tile of white noise is left to the plain way.
TEST(ScoreTiles, SharpTilesOfASmoothMapGetEveryLag) {
  Raster raster = smooth_ground(400, 420, 2, "sharp");
  ground(64, 64, "grain").pixels.copyTo(raster.pixels(cv::Rect(128, 128, 64, 64)));
  Request options = options_of(64, 64, 100);
  options.measures = {ScoreMeasure::kUniqueness};
  const TileScores tile = score(raster, options)[2 * 6 + 2];
  options.every_lag = true;
  const TileScores expected = score(raster, options)[2 * 6 + 2];
  EXPECT_NEAR(tile.clean.rival, expected.clean.rival, 1e-4);
  EXPECT_NEAR(tile.clean.psr, expected.clean.psr, 1e-3 * expected.clean.psr);
  EXPECT_EQ(tile.clean.rivals, expected.clean.rivals);
}

TEST(ScoreTiles, LatticesGiveTheSameBytesForAnyThreadsAndAnyChoiceOfTiles) {
  Raster raster = smooth_ground(300, 340, 2, "lattice determinism");
  raster.valid(cv::Rect(280, 200, 30, 60)).setTo(0);
  Request options = options_of(64, 16, 70);
  options.measures = {ScoreMeasure::kUniqueness, ScoreMeasure::kDegraded};
  const std::vector<TileScores> all = score(raster, options);
  EXPECT_EQ(bits_of(score(raster, options, {}, 3)), bits_of(all));
  std::vector<std::int64_t> some;
  std::vector<TileScores> expected;
  for (std::size_t i = 2; i < all.size(); i += 5) {
    some.push_back(static_cast<std::int64_t>(i));
    expected.push_back(all[i]);
  }
  EXPECT_EQ(bits_of(score(raster, options, some, 2)), bits_of(expected));
}

TEST(ScoreTiles, SixteenBitAndDoubleGiveTheSameSurfaces) {
  const Raster bytes = ground(80, 90, "depths");
  Request options = options_of(32, 16, 12);
  const std::vector<TileScores> expected = score(bytes, options);
  Raster words = bytes;
  bytes.pixels.convertTo(words.pixels, CV_16U, 200, 300);
  Raster doubles = bytes;
  bytes.pixels.convertTo(doubles.pixels, CV_64F, 1.0 / 255, -0.5);
  for (const Raster& raster : {words, doubles}) {
    const std::vector<TileScores> scores = score(raster, options);
    for (std::size_t i = 0; i < scores.size(); ++i) {
      EXPECT_NEAR(scores[i].clean.rival, expected[i].clean.rival, 1e-4);
      EXPECT_NEAR(scores[i].degraded.margin, expected[i].degraded.margin, 1e-3);
    }
  }
}

TEST(ScoreTiles, SameBytesForAnyThreadsAndAnyChoiceOfTiles) {
  Raster raster = ground(180, 200, "determinism");
  raster.valid(cv::Rect(150, 100, 30, 60)).setTo(0);
  Request options = options_of(32, 8, 16);
  const std::vector<TileScores> all = score(raster, options);
  EXPECT_EQ(bits_of(score(raster, options, {}, 2)), bits_of(all));
  EXPECT_EQ(bits_of(score(raster, options, {}, 5)), bits_of(all));
  std::vector<std::int64_t> some;
  std::vector<TileScores> expected;
  for (std::size_t i = (all.size() - 3) % 7; i < all.size(); i += 7) {
    some.push_back(static_cast<std::int64_t>(i));
    expected.push_back(all[i]);
  }
  EXPECT_EQ(bits_of(score(raster, options, some, 3)), bits_of(expected));
}

TEST(ScoreTiles, OnlyWhatIsAskedForIsMeasured) {
  const Raster raster = ground(70, 70, "asked");
  Request options = options_of(32, 16, 8);
  const std::vector<TileScores> all = score(raster, options);
  for (const ScoreMeasure measure : options.measures) {
    Request one = options;
    one.measures = {measure};
    if (!one.measures_surface()) one.search_radius_px = 0;
    const TileScores tile = score(raster, one)[2];
    const bool model = measure == ScoreMeasure::kCorrectFix;  // which needs V and the deficit
    EXPECT_EQ(std::isnan(tile.p_correct_fix), !model);
    EXPECT_EQ(std::isnan(tile.gray_variance), !model && measure != ScoreMeasure::kGrayVariance);
    EXPECT_EQ(std::isnan(tile.frieden_entropy), !model && measure != ScoreMeasure::kFriedenEntropy);
    EXPECT_EQ(std::isnan(tile.frieden_deficit), !model && measure != ScoreMeasure::kFriedenEntropy);
    EXPECT_EQ(std::isnan(tile.clean.peak), measure != ScoreMeasure::kUniqueness);
    EXPECT_EQ(std::isnan(tile.degraded.peak), measure != ScoreMeasure::kDegraded);
    if (measure == ScoreMeasure::kDegraded) {
      EXPECT_EQ(tile.degraded.margin, all[2].degraded.margin);
    }
  }
}

TEST(ScoreTiles, ThePlannersUsualContrastReplacesThatOfTheGrid) {
  const Raster raster = ground(160, 160, "usual");
  Request options = options_of(64, 48, 8);
  options.measures = {ScoreMeasure::kCorrectFix};
  options.usual_fine_contrast = 10;
  const std::vector<TileScores> at_10 = score(raster, options);
  options.usual_fine_contrast = 20;
  const std::vector<TileScores> at_20 = score(raster, options);
  ASSERT_GT(at_10[0].fine_contrast, 0);
  for (std::size_t i = 0; i < at_10.size(); ++i) {
    EXPECT_NEAR(at_20[i].fine_contrast, at_10[i].fine_contrast / 2, 1e-12);
    EXPECT_LE(at_20[i].p_correct_fix, at_10[i].p_correct_fix) << "poorer than other ground";
  }
}

TEST(ScoreTiles, DegradedCopiesMatchWorseThanCleanOnes) {
  const Raster raster = ground(140, 140, "degraded");
  for (const TileScores& tile : score(raster, options_of(64, 16, 24))) {
    EXPECT_LT(tile.degraded.peak, 0.99 * tile.clean.peak);
    EXPECT_GT(tile.degraded.peak, 0.2);
    EXPECT_LT(tile.degraded.margin, tile.clean.margin);
  }
}

/// With every effect off, a copy is the tile itself: both ways to compute a surface must then agree.
TEST(ScoreTiles, UndegradedCopyIsClean) {
  Request options = options_of(32, 8, 16);
  options.degradation = {0, 0, 0, 3, 0, 0, 0, 0};
  for (const TileScores& tile : score(ground(100, 110, "undegraded"), options)) {
    EXPECT_NEAR(tile.degraded.peak, tile.clean.peak, 1e-5);
    EXPECT_NEAR(tile.degraded.rival, tile.clean.rival, 1e-5);
    EXPECT_NEAR(tile.degraded.psr, tile.clean.psr, 1e-3 * tile.clean.psr);
  }
}

TEST(ScoreTiles, RepeatedGroundHasARivalWhereItRepeats) {
  Raster raster = ground(128, 160, "repeat");
  raster.pixels(cv::Rect(32, 32, 32, 32)).copyTo(raster.pixels(cv::Rect(52, 25, 32, 32)));
  const cv::Mat kept = raster.pixels(cv::Rect(52, 25, 32, 32)).clone();
  kept.copyTo(raster.pixels(cv::Rect(32, 64, 32, 32)));
  Request options = options_of(32, 32, 60);
  const std::vector<TileScores> scores = score(raster, options);
  const TileScores& tile = scores[2 * 5 + 1];  // column 1, row 2: first pixel (32, 64), its twin at (52, 25)
  ASSERT_EQ(scores.size(), 4U * 5U);
  EXPECT_NEAR(tile.clean.rival, 1, 1e-4);
  EXPECT_EQ(tile.clean.rival_dx_px, 20);
  EXPECT_EQ(tile.clean.rival_dy_px, -39);
  EXPECT_NEAR(tile.clean.margin, 0, 1e-4);
  EXPECT_GE(tile.clean.rivals, 1);
}

TEST(ScoreTiles, FlatEmptyAndPartlyCoveredTilesAreDefined) {
  Raster raster = ground(96, 128, "special");
  raster.pixels(cv::Rect(0, 0, 32, 32)).setTo(80);
  raster.valid(cv::Rect(96, 0, 32, 96)).setTo(0);
  raster.valid(cv::Rect(64, 64, 8, 32)).setTo(0);
  raster.pixels.setTo(255, raster.valid == 0);
  const std::vector<TileScores> scores = score(raster, options_of(32, 32, 20));
  const auto at = [&](int column, int row) { return scores[static_cast<std::size_t>(4 * row + column)]; };

  EXPECT_EQ(at(0, 0).status, TileStatus::kFlat);
  EXPECT_EQ(at(0, 0).gray_variance, 0);
  EXPECT_NEAR(at(0, 0).frieden_entropy, std::exp(1 - 1.0 / 1024), 1e-12);
  EXPECT_TRUE(std::isnan(at(0, 0).clean.peak));
  EXPECT_TRUE(std::isnan(at(0, 0).degraded.peak));

  EXPECT_EQ(at(3, 1).status, TileStatus::kTooLittleGround);
  EXPECT_EQ(at(3, 1).valid_fraction, 0);
  EXPECT_TRUE(std::isnan(at(3, 1).gray_variance));
  EXPECT_TRUE(std::isnan(at(3, 1).frieden_entropy));

  const TileScores partly = at(2, 2);
  EXPECT_EQ(partly.status, TileStatus::kScored);
  EXPECT_EQ(partly.valid_fraction, 0.75);
  EXPECT_NEAR(partly.clean.peak, 1, 1e-3);
  EXPECT_LT(partly.clean.rival, 0.8);
  EXPECT_GT(partly.degraded.peak, 0.2);
  const cv::Rect rect(64, 64, 32, 32);
  const GrayStatistics expected = gray_statistics(raster.pixels(rect), raster.valid(rect));
  EXPECT_NEAR(partly.gray_variance, expected.gray_variance, 1e-9);
  EXPECT_NEAR(partly.frieden_entropy, expected.frieden_entropy, 1e-9);
}

/// What stands in pixels without ground must not reach any score.
TEST(ScoreTiles, PixelsWithoutGroundDoNotMatter) {
  Raster raster = ground(96, 128, "garbage");
  raster.valid(cv::Rect(90, 0, 38, 50)).setTo(0);
  Raster other = raster;
  other.pixels = raster.pixels.clone();
  other.pixels.setTo(1, raster.valid == 0);
  raster.pixels.setTo(255, raster.valid == 0);
  const Request options = options_of(32, 8, 16);
  EXPECT_EQ(bits_of(score(raster, options)), bits_of(score(other, options)));
}

TEST(ScoreTiles, NotFinitePixelsAreNoGround) {
  Raster raster = ground(64, 64, "nan");
  raster.pixels.convertTo(raster.pixels, CV_64F);
  raster.pixels(cv::Rect(40, 40, 10, 10)).setTo(std::nan(""));
  for (const TileScores& tile : score(raster, options_of(32, 16, 8))) {
    EXPECT_TRUE(std::isfinite(tile.gray_variance));
    EXPECT_TRUE(std::isfinite(tile.clean.margin));
  }
}

TEST(ScoreTiles, ErrorsNameThingAndValue) {
  const Raster raster = ground(40, 50, "errors");
  const GraySource source = gray_source_from(raster);
  EXPECT_EQ(error_of<std::exception>([&] { score(raster, options_of(64, 16, 8)); }),
            "a tile of 64 x 64 px is larger than the imagery of 50 x 40 px");
  EXPECT_THAT(error_of<std::exception>([&] { score(raster, options_of(32, 16, 0)); }),
              ::testing::HasSubstr("search_radius_px = 0"));
  EXPECT_THROW(score(raster, options_of(32, 16, 0)), UsageError);
  Request nothing = options_of(32, 16, 8);
  nothing.measures.clear();
  EXPECT_THROW(score(raster, nothing), UsageError);
  EXPECT_THROW(score(raster, options_of(32, 8, 8), {99}), UsageError);
  EXPECT_THROW(score(raster, options_of(32, 8, 8), {1, 1}), UsageError);
  EXPECT_EQ(error_of<UsageError>([&] {
              score(raster, options_of(32, 8, 8), {2, 1});
            }),
            "tile index 1 follows 2: indices must ascend, without duplicates");
  Request copies = options_of(32, 8, 8);
  copies.degraded_copies = 0;
  EXPECT_THAT(error_of<std::exception>([&] { score(raster, copies); }), ::testing::HasSubstr("degraded_copies = 0"));
  TileMatrix other = matrix_of(source, options_of(32, 8, 8));
  other.grid_width_px = 51;
  EXPECT_THROW(score_tiles(source, other, 8, all_tiles(other), options_of(32, 8, 8)), DataError);
  const std::vector<std::int64_t> first{0};
  TileMatrix no_stride = testing::matrix_over(source, 32, 8);
  no_stride.stride_px = 0;
  EXPECT_THROW(score_tiles(source, no_stride, 8, first, options_of(32, 8, 8)), UsageError);
  const TileMatrix too_large = testing::matrix_over(source, 4096, 8);
  EXPECT_THROW(score_tiles(source, too_large, 8, first, options_of(32, 8, 8)), DataError);
}

TEST(ScoreTiles, ReadErrorsComeThrough) {
  GraySource source = gray_source_from(ground(200, 200, "read error"));
  source.read = [](const PixelWindow&) -> Raster { throw DataError("block 3 is damaged"); };
  const Request options = options_of(32, 16, 8);
  const TileMatrix matrix = matrix_of(source, options);
  EXPECT_THROW(score_tiles(source, matrix, 8, all_tiles(matrix), options), DataError);
}

TEST(ScoreTiles, ProgressCountsAndStops) {
  const GraySource source = gray_source_from(ground(100, 100, "progress"));
  const Request options = options_of(32, 16, 8);
  const TileMatrix matrix = matrix_of(source, options);
  std::map<std::string, std::int64_t, std::less<>> last;
  score_tiles(source, matrix, 8, all_tiles(matrix), options, 1, 1,
              [&](std::string_view what, std::int64_t done, std::int64_t total) {
                const auto [of_work, is_new] = last.try_emplace(std::string(what), -1);
                EXPECT_GE(done, of_work->second) << what;
                EXPECT_LE(done, total) << what;
                of_work->second = done;
                return true;
              });
  EXPECT_EQ(last.size(), 4U) << "scoring, usual contrast, fine contrast, then counting votes";
  EXPECT_EQ(last["score"], matrix.tile_count());
  const Progress stop = [](std::string_view, std::int64_t done, std::int64_t) { return done == 0; };
  EXPECT_THROW(score_tiles(source, matrix, 8, all_tiles(matrix), options, 1, 1, stop), Interrupted);
}

}  // namespace
}  // namespace pilotage
