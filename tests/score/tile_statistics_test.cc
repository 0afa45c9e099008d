#include "pilotage/score/tile_statistics.h"

#include <map>
#include <mutex>
#include <string_view>
#include <utility>

#include "testing/matrix_over.h"
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"
#include "pilotage/geo/tile_groups.h"
#include "pilotage/score/gray_statistics.h"

namespace pilotage {
namespace {

using testing::matrix_over;

Raster noise(int width, int height, std::string_view name) {
  Random random(seed_from_name(name));
  Raster raster{cv::Mat(height, width, CV_8U), cv::Mat(height, width, CV_8U, cv::Scalar(255)), {}};
  for (int row = 0; row < height; ++row) {
    for (int col = 0; col < width; ++col) raster.pixels.at<std::uint8_t>(row, col) = random.below(256) & 255;
  }
  raster.valid(cv::Rect(width / 2, height / 3, 40, 30)).setTo(0);
  return raster;
}

/// Some tiles of a matrix and their scores.
struct Tiles {
  std::vector<TileCell> cells;
  std::vector<TileScores> scores;

  std::vector<MeasuredTile> measured() {
    std::vector<MeasuredTile> list;
    for (std::size_t i = 0; i < cells.size(); ++i) list.push_back({cells[i], &scores[i]});
    return list;
  }
  void add(const TileCell& cell, const TileScores& score = {}) {
    cells.push_back(cell);
    scores.push_back(score);
  }
};

/// Tiles of every `step`-th index.
Tiles tiles_of(const TileMatrix& matrix, std::int64_t step) {
  Tiles tiles;
  for (std::int64_t index = 0; index < matrix.tile_count(); index += step) tiles.add(matrix.cell_of(index));
  return tiles;
}

void expect_as_pixels(const Raster& raster, const TileMatrix& matrix, const Tiles& tiles) {
  for (std::size_t i = 0; i < tiles.cells.size(); ++i) {
    const TileScores& tile = tiles.scores[i];
    const PixelWindow window = matrix.tile_window(tiles.cells[i]);
    const cv::Rect rect(static_cast<int>(window.col), static_cast<int>(window.row), window.width, window.height);
    const GrayStatistics oracle = gray_statistics(raster.pixels(rect), raster.valid(rect));
    ASSERT_DOUBLE_EQ(tile.valid_fraction, static_cast<double>(oracle.count) / rect.area());
    ASSERT_NEAR(tile.gray_variance, oracle.gray_variance, 1e-10 * oracle.gray_variance);
    ASSERT_NEAR(tile.frieden_entropy, oracle.frieden_entropy, 1e-10 * oracle.frieden_entropy);
  }
}

/// A source in blocks that counts how often each is read.
struct CountedReads {
  std::mutex mutex;
  std::map<std::pair<std::int64_t, std::int64_t>, int> of_block;
};

GraySource in_blocks(const Raster& raster, int width, int height, CountedReads& reads) {
  GraySource source = gray_source_from(raster);
  source.block_width_px = width;
  source.block_height_px = height;
  source.read = [whole = source.read, width, height, &reads](const PixelWindow& window) {
    const std::lock_guard lock(reads.mutex);
    for (std::int64_t row = window.row / height; row * height < window.row + window.height; ++row) {
      for (std::int64_t col = window.col / width; col * width < window.col + window.width; ++col) {
        ++reads.of_block[{row, col}];
      }
    }
    return whole(window);
  };
  return source;
}

/// Three strips of the map, the last of them short.
TEST(TileStatistics, StreamsWhatTheOracleSaysAndReadsEachBlockOnce) {
  const Raster raster = noise(500, 36'000, "stream");
  const TileMatrix matrix = matrix_over(gray_source_from(raster), 96, 40);
  std::vector<Tiles> results;
  for (const int threads : {1, 3}) {
    CountedReads reads;
    const GraySource source = in_blocks(raster, 130, 300, reads);
    Tiles tiles = tiles_of(matrix, 1);
    stream_statistics(source, matrix, {}, tiles.measured(), threads);
    EXPECT_EQ(reads.of_block.size(), 4U * 120U);
    for (const auto& [block, count] : reads.of_block) EXPECT_EQ(count, 1) << block.first << ", " << block.second;
    results.push_back(std::move(tiles));
  }
  Tiles some;
  for (std::size_t i = 0; i < results[0].cells.size(); i += 17) some.add(results[0].cells[i], results[0].scores[i]);
  expect_as_pixels(raster, matrix, some);
  for (std::size_t i = 0; i < results[0].scores.size(); ++i) {
    ASSERT_EQ(results[0].scores[i].frieden_deficit, results[1].scores[i].frieden_deficit);
  }
}

/// Two slabs of columns. Only the blocks across their border are read for both.
TEST(TileStatistics, AWideMapIsStreamedSlabBySlab) {
  const Raster raster = noise(2 * kSlabWidth_px - 1000, 700, "wide");
  const TileMatrix matrix = matrix_over(gray_source_from(raster), 96, 60);
  CountedReads reads;
  GraySource source = in_blocks(raster, 256, 256, reads);
  std::int64_t rightmost_px = 0;
  bool went_back = false;
  source.read = [&, counted = source.read](const PixelWindow& window) {
    if (window.col >= kSlabWidth_px + 256) rightmost_px = window.col;
    if (rightmost_px > 0 && window.col < kSlabWidth_px - 256) went_back = true;
    return counted(window);
  };
  Tiles tiles = tiles_of(matrix, 1);
  std::int64_t told = 0;
  stream_statistics(source, matrix, {}, tiles.measured(), 1,
                    [&](std::string_view, std::int64_t done, std::int64_t total) {
                      EXPECT_GE(done, told);
                      EXPECT_EQ(total, matrix.tile_count());
                      told = done;
                      return true;
                    });
  EXPECT_EQ(told, matrix.tile_count());
  EXPECT_FALSE(went_back);
  EXPECT_EQ(reads.of_block.size(), 253U * 3U);
  for (const auto& [block, count] : reads.of_block) {
    EXPECT_EQ(count, block.second == kSlabWidth_px / 256 ? 2 : 1) << block.first << ", " << block.second;
  }
  Tiles some;
  for (std::size_t i = 0; i < tiles.cells.size(); i += 13) some.add(tiles.cells[i], tiles.scores[i]);
  expect_as_pixels(raster, matrix, some);

  CountedReads strip_reads;  // strips as wide as the map are decoded for all columns, whoever asks
  Tiles again = tiles_of(matrix, 1);
  stream_statistics(in_blocks(raster, raster.pixels.cols, 8, strip_reads), matrix, {}, again.measured(), 2);
  for (const auto& [strip, count] : strip_reads.of_block) EXPECT_EQ(count, 1) << strip.first;
  for (std::size_t i = 0; i < tiles.scores.size(); ++i) {
    ASSERT_EQ(tiles.scores[i].frieden_deficit, again.scores[i].frieden_deficit);
  }
}

TEST(TileStatistics, FewTilesAreAsAmongAllAndOthersAreNotRead) {
  const Raster raster = noise(1200, 900, "few");
  const TileMatrix matrix = matrix_over(gray_source_from(raster), 50, 25);
  Tiles all = tiles_of(matrix, 1);
  score_statistics({{0, 0, 1200, 900}, raster.pixels, raster.valid}, matrix, {}, all.measured(), 2);
  CountedReads reads;
  const GraySource source = in_blocks(raster, 300, 300, reads);
  Tiles few;
  for (const std::size_t index : {3U, 7U, 49U}) few.add(all.cells[index], all.scores[index]);
  for (TileScores& tile : few.scores) tile.frieden_deficit = tile.gray_variance = -1;
  stream_statistics(source, matrix, {}, few.measured(), 2);
  EXPECT_EQ(few.scores[0].frieden_deficit, all.scores[3].frieden_deficit);
  EXPECT_EQ(few.scores[1].frieden_deficit, all.scores[7].frieden_deficit);
  EXPECT_EQ(few.scores[2].gray_variance, all.scores[49].gray_variance);
  EXPECT_EQ(reads.of_block.size(), 1U);  // all three lie in the first block
}

TEST(TileStatistics, AreComputedInAnyWindowAndOrder) {
  const Raster raster = noise(700, 400, "window");
  const TileMatrix matrix = matrix_over(gray_source_from(raster), 64, 16);
  Tiles tiles = tiles_of(matrix, 7);
  std::erase_if(tiles.cells, [](const TileCell& cell) { return cell.column < 3 || cell.row < 2; });
  tiles.scores.resize(tiles.cells.size());
  std::vector<MeasuredTile> backwards = tiles.measured();
  std::reverse(backwards.begin(), backwards.end());
  const cv::Rect part(37, 11, 663, 389);  // begins between two tiles
  score_statistics({{part.x, part.y, part.width, part.height}, raster.pixels(part), raster.valid(part)}, matrix, {},
                   backwards, 2);
  expect_as_pixels(raster, matrix, tiles);
}

TEST(TileStatistics, NoTilesAreNothing) {
  const Raster raster = noise(300, 300, "none");
  CountedReads reads;
  stream_statistics(in_blocks(raster, 300, 16, reads), matrix_over(gray_source_from(raster), 64, 64), {}, {}, 1);
  EXPECT_TRUE(reads.of_block.empty());
}

TEST(TileStatistics, AnErrorOfReadingIsTold) {
  const Raster raster = noise(300, 300, "error");
  GraySource source = gray_source_from(raster);
  source.read = [](const PixelWindow&) -> Raster { throw DataError("broken"); };
  const TileMatrix matrix = matrix_over(source, 64, 64);
  Tiles tiles = tiles_of(matrix, 1);
  EXPECT_THROW(stream_statistics(source, matrix, {}, tiles.measured(), 2), DataError);
}

}  // namespace
}  // namespace pilotage
