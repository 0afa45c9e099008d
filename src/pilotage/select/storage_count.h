#pragma once

#include <cstdint>
#include <map>
#include <tuple>

#include "pilotage/mission/mission.h"
#include "pilotage/mission/stored_size.h"

namespace pilotage {

/// Counts the bytes that chosen tiles need at most, overlap counted once: the ground is cut into squares of one stride.
/// The plan must outlive it.
class StorageCount {
 public:
  StorageCount(const Mission& mission, const StoredSize& size);

  double bytes() const { return bytes_; }
  /// What `tile` would add.
  double bytes_of(const GroundTile& tile) const;
  void add(const GroundTile& tile);
  /// Takes away a tile that was added.
  void remove(const GroundTile& tile);

 private:
  double cell_bytes(const GroundTile& tile) const;

  const Mission* mission_;
  StoredSize size_;
  double bytes_ = 0;
  std::map<std::tuple<int, std::int64_t, std::int64_t>, int> cells_;  ///< Tiles over level, row, column.
};

}  // namespace pilotage
