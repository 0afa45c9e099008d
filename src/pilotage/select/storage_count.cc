#include "pilotage/select/storage_count.h"

namespace pilotage {
namespace {

template <class Visit>
void for_each_cell(const Mission& mission, const GroundTile& tile, Visit visit) {
  const TileMatrix& matrix = mission.ground.levels[static_cast<std::size_t>(tile.level)].matrix;
  const int cells = (matrix.tile_size_px + matrix.stride_px - 1) / matrix.stride_px;
  for (int row = 0; row < cells; ++row) {
    for (int column = 0; column < cells; ++column) {
      visit(std::tuple(tile.level, tile.row + row, tile.column + column));
    }
  }
}

}  // namespace

StorageCount::StorageCount(const Mission& mission, const StoredSize& size)
    : mission_(&mission), size_(size), bytes_(size.bytes_fixed) {}

double StorageCount::bytes_of(const GroundTile& tile) const {
  int fresh = 0;
  for_each_cell(*mission_, tile, [&](const auto& cell) { fresh += cells_.contains(cell) ? 0 : 1; });
  return size_.bytes_per_tile + fresh * cell_bytes(tile);
}

void StorageCount::add(const GroundTile& tile) {
  bytes_ += bytes_of(tile);
  for_each_cell(*mission_, tile, [&](const auto& cell) { ++cells_[cell]; });
}

void StorageCount::remove(const GroundTile& tile) {
  for_each_cell(*mission_, tile, [&](const auto& cell) {
    if (--cells_[cell] == 0) cells_.erase(cell);
  });
  bytes_ -= bytes_of(tile);
}

double StorageCount::cell_bytes(const GroundTile& tile) const {
  const auto level = static_cast<std::size_t>(tile.level);
  const double stride_px = mission_->ground.levels[level].matrix.stride_px;
  const double chip_bytes = size_.chip_bytes_per_px.empty() ? 0 : size_.chip_bytes_per_px.at(level);
  return stride_px * stride_px * (size_.bytes_per_px + chip_bytes);
}

}  // namespace pilotage
