#include "pilotage/geo/tile_groups.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "testing/matrix_over.h"
#include <gtest/gtest.h>

namespace pilotage {
namespace {

TileMatrix matrix_of(std::int64_t side_px, int tile_px, int stride_px) {
  GraySource source;
  source.width_px = source.height_px = side_px;
  return testing::matrix_over(source, tile_px, stride_px);
}

bool holds(const PixelWindow& outer, const PixelWindow& inner) {
  return inner.col >= outer.col && inner.row >= outer.row && inner.col + inner.width <= outer.col + outer.width &&
         inner.row + inner.height <= outer.row + outer.height;
}

TEST(TileGroups, EachTileIsInOneGroupInsideItsWindow) {
  for (const TileMatrix& matrix : {matrix_of(3000, 100, 70), matrix_of(5000, 2000, 500)}) {
    const std::vector<std::int64_t> indices = testing::all_tiles(matrix);
    std::vector<int> times(indices.size(), 0);
    const std::vector<TileGroup> groups = group_tiles(matrix, indices, 7, 1);
    EXPECT_GT(groups.size(), 1U);
    for (const TileGroup& group : groups) {
      EXPECT_LE(group.window.width, std::max(1024, matrix.tile_size_px) + 14);
      EXPECT_TRUE(
          holds({0, 0, static_cast<int>(matrix.grid_width_px), static_cast<int>(matrix.grid_height_px)}, group.window));
      for (const std::size_t index : group.result_indices) {
        ++times[index];
        const TileCell cell = matrix.cell_of(indices[index]);
        EXPECT_TRUE(holds(group.window, matrix.search_window(cell, 7)));
        const PixelWindow place = group.place_of(matrix.tile_window(cell));
        EXPECT_EQ(place.col + group.window.col, matrix.tile_window(cell).col);
        EXPECT_TRUE(holds({0, 0, group.window.width, group.window.height}, place));
      }
    }
    EXPECT_EQ(times, std::vector<int>(indices.size(), 1));
  }
}

TileMatrix wide_matrix(std::int64_t width_px, int tile_px, int stride_px) {
  GraySource source;
  source.width_px = width_px;
  source.height_px = 3000;
  return testing::matrix_over(source, tile_px, stride_px);
}

TEST(TileGroups, SlabsAreTheTilesThatBeginInThem) {
  const TileMatrix matrix = wide_matrix(3 * kSlabWidth_px, 200, 150);
  const std::vector<std::int64_t> indices = testing::all_tiles(matrix);
  const auto slabs = tiles_by_slab(matrix, indices, 256);
  ASSERT_EQ(slabs.size(), 3U);
  std::vector<int> times(indices.size(), 0);
  for (std::size_t slab = 0; slab < slabs.size(); ++slab) {
    EXPECT_TRUE(std::is_sorted(slabs[slab].begin(), slabs[slab].end()));
    for (const std::size_t place : slabs[slab]) {
      ++times[place];
      EXPECT_EQ(matrix.tile_window(matrix.cell_of(indices[place])).col / kSlabWidth_px,
                static_cast<std::int64_t>(slab));
    }
  }
  EXPECT_EQ(times, std::vector<int>(indices.size(), 1));
  EXPECT_EQ(tiles_by_slab(matrix, std::vector<std::int64_t>{0, matrix.matrix_width() - 1}, 256).size(), 2U);
  EXPECT_TRUE(tiles_by_slab(matrix, {}, 256).empty());
  const auto of_strips = tiles_by_slab(matrix, indices, static_cast<int>(matrix.grid_width_px));
  ASSERT_EQ(of_strips.size(), 1U) << "each slab would decode the strips of all";
  EXPECT_EQ(of_strips.front().size(), indices.size());
}

/// Down one slab, then the next: a group is never more than a slab's width to the left of one before it.
TEST(TileGroups, OfAWideMapAreInTheOrderOfSlabs) {
  const TileMatrix matrix = wide_matrix(3 * kSlabWidth_px, 200, 150);
  std::int64_t rightmost_px = 0;
  for (const TileGroup& group : group_tiles(matrix, testing::all_tiles(matrix), 0, 512)) {
    EXPECT_LE(rightmost_px - group.window.col, kSlabWidth_px);
    rightmost_px = std::max(rightmost_px, group.window.col);
  }
  EXPECT_GT(rightmost_px, 2 * kSlabWidth_px);
  std::int64_t row_px = 0;  // of strips: row by row
  for (const TileGroup& group :
       group_tiles(matrix, testing::all_tiles(matrix), 0, static_cast<int>(matrix.grid_width_px))) {
    EXPECT_GE(group.window.row, row_px);
    row_px = group.window.row;
  }
}

TEST(TileGroups, RectanglesAreCutFromTheCorner) {
  const TileMatrix matrix = wide_matrix(5000, 200, 100);
  const std::vector<std::int64_t> indices{matrix.index_of(0, 0), matrix.index_of(19, 9), matrix.index_of(20, 9),
                                          matrix.index_of(0, 10), matrix.index_of(20, 12)};
  using Places = std::vector<std::vector<std::size_t>>;
  EXPECT_EQ(tiles_by_rectangle(matrix, indices, 2000, 1000), (Places{{0, 1}, {3}, {2}, {4}}));
}

}  // namespace
}  // namespace pilotage
