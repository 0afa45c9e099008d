#include "pilotage/mapdb/parallel_reading.h"

#include <cstdint>
#include <mutex>
#include <utility>

#include "pilotage/base/parallel.h"

namespace pilotage {

OpenMaps open_unverified_maps(std::vector<std::filesystem::path> paths) {
  return [paths = std::move(paths)] {
    std::vector<MapReader> maps;
    for (const std::filesystem::path& path : paths) maps.push_back(MapReader::open_unverified(path));
    return maps;
  };
}

std::vector<MapReader*> pointers_to(std::span<MapReader> maps) {
  std::vector<MapReader*> pointers;
  for (MapReader& map : maps) pointers.push_back(&map);
  return pointers;
}

std::vector<std::string> names_of(std::span<const MapReader> maps) {
  std::vector<std::string> names;
  for (const MapReader& map : maps) names.push_back(map.name());
  return names;
}

void for_each_with_readers(const OpenMaps& open_maps, std::size_t count, int threads, const std::string& what,
                           const Progress& progress,
                           const std::function<void(std::size_t, std::span<MapReader>)>& body) {
  std::vector<std::vector<MapReader>> readers(static_cast<std::size_t>(thread_count(threads)));
  std::mutex mutex;
  std::int64_t done = 0;
  const auto total = static_cast<std::int64_t>(count);
  report_progress(progress, what, done, total);
  parallel_for(count, threads, [&](std::size_t index, int worker) {
    std::vector<MapReader>& maps = readers[static_cast<std::size_t>(worker)];
    if (maps.empty()) maps = open_maps();
    body(index, maps);
    const std::lock_guard lock(mutex);
    report_progress(progress, what, ++done, total);
  });
}

}  // namespace pilotage
