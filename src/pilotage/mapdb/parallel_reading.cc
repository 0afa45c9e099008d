#include "pilotage/mapdb/parallel_reading.h"

#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "pilotage/base/parallel.h"

namespace pilotage {

void for_each_with_reader(const std::function<MapReader()>& open_map, std::size_t count, int threads,
                          const std::string& what, const Progress& progress,
                          const std::function<void(std::size_t, MapReader&)>& body) {
  std::vector<std::unique_ptr<MapReader>> readers(static_cast<std::size_t>(thread_count(threads)));
  std::mutex mutex;
  std::int64_t done = 0;
  const auto total = static_cast<std::int64_t>(count);
  report_progress(progress, what, done, total);
  parallel_for(count, threads, [&](std::size_t index, int worker) {
    std::unique_ptr<MapReader>& reader = readers[static_cast<std::size_t>(worker)];
    if (!reader) reader = std::make_unique<MapReader>(open_map());
    body(index, *reader);
    const std::lock_guard lock(mutex);
    report_progress(progress, what, ++done, total);
  });
}

}  // namespace pilotage
