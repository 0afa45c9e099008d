#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/mapdb/map_reader.h"

namespace pilotage {

/// Gives a thread readers of its own of the maps that it is to read, at least one. Called by several threads.
using OpenMaps = std::function<std::vector<MapReader>()>;

/// MapReader::open_unverified() of each; throws, when it is called, as that.
OpenMaps open_unverified_maps(std::vector<std::filesystem::path> paths);

/// Their addresses, as match() takes them, and their names, as messages begin.
std::vector<MapReader*> pointers_to(std::span<MapReader> maps);
std::vector<std::string> names_of(std::span<const MapReader> maps);

/// Calls `body(index, maps)` once for each index in [0, count), on up to `threads` threads (0 = all cores), each with
/// readers of its own, and reports progress as `what`. A body writes its result by index, so that results do not depend
/// on the number of threads. Throws what `open_maps` throws when count > 0; what `body` throws (parallel_for);
/// Interrupted.
void for_each_with_readers(const OpenMaps& open_maps, std::size_t count, int threads, const std::string& what,
                           const Progress& progress,
                           const std::function<void(std::size_t, std::span<MapReader>)>& body);

}  // namespace pilotage
