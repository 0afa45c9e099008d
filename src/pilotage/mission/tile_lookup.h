#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "pilotage/mission/mission.h"

namespace pilotage {

/// Finds the tile of a plan that a frame over a point of the route is compared with: the one of the sample's level
/// whose centre is nearest, which is within half a stride in both axes. The plan must outlive the lookup.
class TileLookup {
 public:
  explicit TileLookup(const Mission& plan);

  /// Index into plan.ground.tiles; nothing when the sample has no level or the plan has no tile there.
  std::optional<std::size_t> tile_under(const FlightSample& sample) const;

 private:
  const Mission& plan_;
  std::unordered_map<std::int64_t, std::size_t> index_of_id_;
};

}  // namespace pilotage
