#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/geo/tile_matrix.h"

namespace pilotage {

/// A pass over tiles that goes row by row and keeps rows of what it reads or finds goes down slabs of this width, one
/// after another, so that what it keeps does not grow with the width of the map.
inline constexpr std::int64_t kSlabWidth_px = 1 << 15;

/// The same for a source whose blocks have this width (GraySource::block_width_px): the whole map where blocks are as
/// wide, for each slab would decode all the others.
std::int64_t slab_width_px(std::int64_t map_width_px, int block_width_px);

/// Which of the given indices (row · matrix_width + column) begin in which rectangle of the map, cut every `width_px`
/// and `height_px` from its corner: places in `indices`, ascending, for each rectangle that has tiles, down one column
/// of rectangles, then the next.
std::vector<std::vector<std::size_t>> tiles_by_rectangle(const TileMatrix& matrix,
                                                         std::span<const std::int64_t> indices, std::int64_t width_px,
                                                         std::int64_t height_px);

/// The same for slabs of a source with blocks of this width, from left to right.
std::vector<std::vector<std::size_t>> tiles_by_slab(const TileMatrix& matrix, std::span<const std::int64_t> indices,
                                                    int block_width_px);

/// Neighbouring tiles that are read as one window, so that what overlapping tiles share is read once.
struct TileGroup {
  PixelWindow window;                       ///< The tiles and `halo_px` around them, as far as the grid reaches.
  std::vector<std::size_t> result_indices;  ///< Of the tiles, in the list of indices that was given.

  /// Where a tile of the group lies in its window.
  PixelWindow place_of(const PixelWindow& tile) const {
    return {tile.col - window.col, tile.row - window.row, tile.width, tile.height};
  }
};

/// The tiles with the given indices (row · matrix_width + column) in groups whose windows, without the halo, are about
/// 1,000 px wide and high, or as large as one tile; slab by slab, row by row. Which tiles share a group depends on
/// their places alone.
std::vector<TileGroup> group_tiles(const TileMatrix& matrix, std::span<const std::int64_t> indices, int halo_px,
                                   int block_width_px);

/// Calls `body` for each group on up to `threads` threads (0 = all cores) at a time, and counts groups as `what`.
/// Throws what `body` throws; Interrupted.
void for_each_group(const std::vector<TileGroup>& groups, std::string_view what, int threads, const Progress& progress,
                    const std::function<void(const TileGroup&)>& body);

}  // namespace pilotage
