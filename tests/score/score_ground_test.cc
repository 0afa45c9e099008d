#include "pilotage/score/score_ground.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/random.h"
#include "pilotage/ground/ground_imagery.h"
#include "pilotage/ground/ground_of_rasters.h"
#include "pilotage/ground/tile_table.h"
#include "pilotage/matchability/reasons.h"
#include "pilotage/raster/shared_blocks.h"
#include "pilotage/score/add_ground_cover.h"

namespace pilotage {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// A tile whose best rival is 10 px to the right of it.
TileScores repeating(double p) {
  TileScores score;
  score.valid_fraction = 1;
  score.p_correct_fix = p;
  score.clean.peak = 1;
  score.clean.rival_ratio = 0.95;
  score.clean.rival_dx_px = 10;
  score.clean.rival_dy_px = 0;
  score.relief_m = 30;
  return score;
}

/// Two levels, flown over from 60 m and from 600 m.
Ground two_levels() {
  Ground ground;
  ground.crs = Crs::from_user_input("EPSG:32633");
  for (int number = 0; number < 2; ++number) {
    GridLevel level;
    level.matrix = {number, GeoTransform::north_up(500000, 5000000, 1 + number), 1000, 1000, 400, 400};
    level.gsd_m = 1 + number;
    level.min_agl_m = number == 0 ? 60 : 6000;
    level.max_agl_m = 10 * level.min_agl_m;
    ground.levels.push_back(level);
    for (std::int64_t column = 0; column < 2; ++column) {
      GroundTile tile;
      tile.tile_id = tile_id_of(ground.levels, number, column, 0);
      tile.level = number;
      tile.column = column;
      ground.tiles.push_back(tile);
    }
  }
  return ground;
}

TEST(ExplainScores, HoldsEachTileAgainstItsOwnLevel) {
  const Ground ground = two_levels();
  std::vector<TileScores> scores{repeating(0.3), repeating(0.95), repeating(0.3), repeating(0.95)};
  scores[1].reasons = scores[3].reasons = {ReasonCode::kWater};  // of an earlier look
  explain_scores(ground, scores);
  for (const std::size_t i : {0U, 2U}) {
    const ReasonContext context = reason_context(ground.crs, ground.levels[i / 2]);
    EXPECT_EQ(scores[i].reasons, reason_codes(scores[i], context));
  }
  EXPECT_THAT(scores[0].reasons, ::testing::Contains(ReasonCode::kRelief)) << "30 m of relief seen from 60 m";
  EXPECT_THAT(scores[2].reasons, ElementsAre(ReasonCode::kRepeats)) << "and from 6000 m";
  EXPECT_THAT(scores[1].reasons, IsEmpty());
  EXPECT_THAT(scores[3].reasons, IsEmpty());
}

/// A window of textured ground without end, no larger than what repeats.
cv::Mat ground_in(const PixelWindow& window) {
  constexpr int kPeriod_px = 700;
  static const cv::Mat four_pieces = [] {
    Random random(seed_from_name("parts"));
    cv::Mat noise(kPeriod_px, kPeriod_px, CV_32F);
    for (int y = 0; y < noise.rows; ++y) {
      for (int x = 0; x < noise.cols; ++x) noise.at<float>(y, x) = static_cast<float>(random.below(1000));
    }
    cv::GaussianBlur(noise, noise, {}, 2);
    cv::normalize(noise, noise, 0, 255, cv::NORM_MINMAX);
    cv::Mat gray;
    noise.convertTo(gray, CV_8U);
    cv::Mat colors;
    cv::cvtColor(cv::repeat(gray, 2, 2), colors, cv::COLOR_GRAY2RGB);
    return colors;
  }();
  return four_pieces(cv::Rect(static_cast<int>(window.col % kPeriod_px), static_cast<int>(window.row % kPeriod_px),
                              window.width, window.height))
      .clone();
}

/// Imagery in blocks that counts how often each is made.
struct CountedImagery {
  std::mutex mutex;
  std::map<std::pair<std::int64_t, std::int64_t>, int> made;

  GroundImagery open(const TileMatrix& matrix, std::int64_t kept_bytes) {
    ColorSource colors;
    colors.width_px = matrix.grid_width_px;
    colors.height_px = matrix.grid_height_px;
    colors.map_from_pixel = matrix.map_from_pixel;
    colors.depth = CV_8U;
    colors.block_width_px = 512;
    colors.block_height_px = 128;
    colors.read = [this](const PixelWindow& window) {
      {
        const std::lock_guard lock(mutex);
        ++made[{window.row, window.col}];
      }
      const cv::Mat pixels = ground_in(window);
      return Raster{pixels, cv::Mat(pixels.size(), CV_8U, cv::Scalar(255)), {}};
    };
    const ColorSource shared = share_blocks(colors, kept_bytes);
    GroundImagery imagery;
    imagery.levels.push_back({gray_source_of(shared), shared, kept_pixels(shared, kept_bytes)});
    return imagery;
  }
};

/// A grid of which a part stays in memory, high or wide.
struct PartsCase {
  const char* name;
  TileMatrix matrix;
  std::int64_t every;  // column and row of tiles is asked for
  std::int64_t parts;
};

class ScoreGroundInParts : public ::testing::TestWithParam<PartsCase> {};

/// All measures go over a part while its blocks are kept: what lies between two parts is made for both, everything else
/// once. Four passes over the whole grid would make each block four times. Tiles are what they are when each measure
/// goes over all of them, and the count of tiles only grows.
TEST_P(ScoreGroundInParts, EachTileIsAsAmongAllAndEachBlockIsMadeOnce) {
  const PartsCase& param = GetParam();
  constexpr std::int64_t kKeptBytes = std::int64_t{32} << 20;
  Ground ground;
  ground.crs = Crs::from_user_input("EPSG:32633");
  GridLevel level;
  level.matrix = param.matrix;
  level.gsd_m = 0.5;
  level.search_radius_px = 32;
  ground.levels.push_back(level);
  std::vector<std::int64_t> indices;
  for (std::int64_t row = 0; row < level.matrix.matrix_height(); row += param.every) {
    for (std::int64_t column = 0; column < level.matrix.matrix_width(); column += param.every) {
      indices.push_back(level.matrix.index_of(column, row));
    }
  }
  cut_tiles(ground, indices);
  ScoreOptions options;
  options.measures = {ScoreMeasure::kUniqueness, ScoreMeasure::kGroundCover, ScoreMeasure::kCorrectFix};
  options.usual_fine_contrast = 1;  // its windows are spread over the grid
  CountedImagery counted;
  const GroundImagery imagery = counted.open(level.matrix, kKeptBytes);

  std::vector<std::string> order;
  std::int64_t told = 0;
  const auto scores = score_ground_tiles(
      ground, options, nullptr, 1, 2,
      [&](std::string_view what, std::int64_t done, std::int64_t total) {
        if (order.empty() || order.back() != what) order.emplace_back(what);
        if (total == 0) return true;  // the sparse sample
        EXPECT_EQ(total, std::ssize(indices)) << what;
        EXPECT_GE(done, told) << what;
        told = done;
        return true;
      },
      &imagery);
  EXPECT_EQ(told, std::ssize(indices));
  EXPECT_EQ(std::count(order.begin(), order.end(), "ground cover"), param.parts);
  std::int64_t times = 0;
  for (const auto& [block, made] : counted.made) times += made;
  EXPECT_LT(times, 2 * std::ssize(counted.made)) << "of " << counted.made.size() << " blocks";

  const GrayAndColors& pixels = imagery.levels.front();
  std::vector<TileScores> at_once =
      score_tiles(pixels.gray, level.matrix, level.search_radius_px, indices, options, 1, 2);
  std::optional<double> white;
  add_ground_cover(pixels.colors, white, level.matrix, indices, at_once, 1, {});
  EXPECT_GT(at_once.front().map_features, 10);
  EXPECT_EQ(tile_table_to_csv(ground, scores), tile_table_to_csv(ground, at_once));
}

INSTANTIATE_TEST_SUITE_P(
    Grids, ScoreGroundInParts,
    ::testing::Values(
        PartsCase{"high", {0, GeoTransform::north_up(500000, 5000000, 0.5), 1536, 12'000, 128, 128}, 2, 5},
        PartsCase{"wide", {0, GeoTransform::north_up(500000, 5000000, 0.5), 12'000, 1536, 128, 16}, 11, 4}),
    [](const auto& of_case) { return of_case.param.name; });

}  // namespace
}  // namespace pilotage
