#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "pilotage/base/progress.h"
#include "pilotage/mapdb/map_reader.h"

namespace pilotage {

/// Calls `body(index, map)` once for each index in [0, count), on up to `threads` threads (0 = all cores), each with a
/// reader of its own, which `open_map` (called by several threads) gives it, and reports progress as `what`. A body
/// writes its result by index, so that results do not depend on the number of threads. Throws what `open_map` throws
/// when count > 0; what `body` throws (parallel_for); Interrupted.
void for_each_with_reader(const std::function<MapReader()>& open_map, std::size_t count, int threads,
                          const std::string& what, const Progress& progress,
                          const std::function<void(std::size_t, MapReader&)>& body);

}  // namespace pilotage
