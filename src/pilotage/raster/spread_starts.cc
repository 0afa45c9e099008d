#include "pilotage/raster/spread_starts.h"

#include <algorithm>

namespace pilotage {

std::vector<std::int64_t> spread_starts(std::int64_t extent_px, std::int64_t side_px, std::int64_t count) {
  const std::int64_t last = std::max<std::int64_t>(extent_px - side_px, 0);
  std::vector<std::int64_t> starts;
  for (std::int64_t i = 0; i < count; ++i) starts.push_back(count == 1 ? 0 : last * i / (count - 1));
  return starts;
}

}  // namespace pilotage
