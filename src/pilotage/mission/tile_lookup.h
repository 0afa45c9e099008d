#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "pilotage/mission/tile_plan.h"

namespace pilotage {

/// The tile_id of a matrix cell: ids count the cells of level 0 row by row, then those of level 1, and so on, so that
/// they are unique over all levels and ascend in (level, row, column).
std::int64_t tile_id_of(const std::vector<PlanLevel>& levels, int level, std::int64_t column, std::int64_t row);

/// Finds the tile of a plan that a frame over a point of the route is compared with: the one of the sample's level
/// whose centre is nearest, which is within half a stride in both axes. The plan must outlive the lookup.
class TileLookup {
 public:
  explicit TileLookup(const TilePlan& plan);

  /// Index into plan.tiles; nothing when the sample has no level or the plan has no tile there.
  std::optional<std::size_t> tile_under(const PlanSample& sample) const;

 private:
  const TilePlan& plan_;
  std::unordered_map<std::int64_t, std::size_t> index_of_id_;
};

}  // namespace pilotage
