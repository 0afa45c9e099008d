#include "pilotage/geo/tile_groups.h"

#include <algorithm>
#include <array>
#include <map>
#include <mutex>
#include <utility>

#include "pilotage/base/parallel.h"

namespace pilotage {

std::vector<std::vector<std::size_t>> tiles_by_rectangle(const TileMatrix& matrix,
                                                         std::span<const std::int64_t> indices, std::int64_t width_px,
                                                         std::int64_t height_px) {
  std::map<std::pair<std::int64_t, std::int64_t>, std::vector<std::size_t>> rectangles;
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const auto [column, row] = matrix.cell_of(indices[i]);
    rectangles[{column * matrix.stride_px / width_px, row * matrix.stride_px / height_px}].push_back(i);
  }
  std::vector<std::vector<std::size_t>> list;
  for (auto& [place, tiles] : rectangles) list.push_back(std::move(tiles));
  return list;
}

std::int64_t slab_width_px(std::int64_t map_width_px, int block_width_px) {
  return block_width_px >= map_width_px ? map_width_px : kSlabWidth_px;
}

std::vector<std::vector<std::size_t>> tiles_by_slab(const TileMatrix& matrix, std::span<const std::int64_t> indices,
                                                    int block_width_px) {
  return tiles_by_rectangle(matrix, indices, slab_width_px(matrix.grid_width_px, block_width_px),
                            matrix.grid_height_px);
}

std::vector<TileGroup> group_tiles(const TileMatrix& matrix, std::span<const std::int64_t> indices, int halo_px,
                                   int block_width_px) {
  constexpr int kGroupSide_px = 1024;
  const std::int64_t across = std::max(1, (kGroupSide_px - matrix.tile_size_px) / matrix.stride_px + 1);
  const std::int64_t group_px = across * matrix.stride_px;
  const std::int64_t slab =
      (slab_width_px(matrix.grid_width_px, block_width_px) + group_px - 1) / group_px;  // in groups
  std::map<std::array<std::int64_t, 3>, TileGroup> groups;
  for (std::size_t result_index = 0; result_index < indices.size(); ++result_index) {
    const auto [column, row] = matrix.cell_of(indices[result_index]);
    const PixelWindow reach = matrix.search_window(column, row, halo_px);
    TileGroup& group = groups[{column / across / slab, row / across, column / across}];
    if (group.result_indices.empty()) group.window = reach;
    const std::int64_t end_col = std::max(group.window.col + group.window.width, reach.col + reach.width);
    const std::int64_t end_row = std::max(group.window.row + group.window.height, reach.row + reach.height);
    group.window.col = std::min(group.window.col, reach.col);
    group.window.row = std::min(group.window.row, reach.row);
    group.window.width = static_cast<int>(end_col - group.window.col);
    group.window.height = static_cast<int>(end_row - group.window.row);
    group.result_indices.push_back(result_index);
  }
  std::vector<TileGroup> list;
  for (auto& [key, group] : groups) list.push_back(std::move(group));
  return list;
}

void for_each_group(const std::vector<TileGroup>& groups, std::string_view what, int threads, const Progress& progress,
                    const std::function<void(const TileGroup&)>& body) {
  std::mutex progress_mutex;
  std::int64_t done = 0;
  const auto report = [&] { report_progress(progress, what, done, static_cast<std::int64_t>(groups.size())); };
  report();
  parallel_for(groups.size(), threads, [&](std::size_t index, int) {
    body(groups[index]);
    const std::lock_guard lock(progress_mutex);
    ++done;
    report();
  });
}

}  // namespace pilotage
