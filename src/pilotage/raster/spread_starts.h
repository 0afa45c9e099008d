#pragma once

#include <cstdint>
#include <vector>

namespace pilotage {

/// First pixels of `count` windows of `side_px` along an extent, evenly spread: the first at its start, the last at its
/// end. Windows longer than the extent start at 0. count ≥ 1.
std::vector<std::int64_t> spread_starts(std::int64_t extent_px, std::int64_t side_px, std::int64_t count);

}  // namespace pilotage
