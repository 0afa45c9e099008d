#pragma once

#include <cstdint>
#include <map>
#include <tuple>

#include "pilotage/mission/stored_size.h"
#include "pilotage/mission/tile_plan.h"

namespace pilotage {

/// Counts the bytes that chosen tiles need at most, overlap counted once: the ground is cut into squares of one stride.
/// The plan must outlive it.
class StorageCount {
 public:
  StorageCount(const TilePlan& plan, const StoredSize& size);

  double bytes() const { return bytes_; }
  /// What `tile` would add.
  double bytes_of(const PlanTile& tile) const;
  void add(const PlanTile& tile);
  /// Takes away a tile that was added.
  void remove(const PlanTile& tile);

 private:
  double cell_bytes(const PlanTile& tile) const;

  const TilePlan* plan_;
  StoredSize size_;
  double bytes_ = 0;
  std::map<std::tuple<int, std::int64_t, std::int64_t>, int> cells_;  ///< Tiles over level, row, column.
};

}  // namespace pilotage
