#include "pilotage/flightlog/match_flight.h"

#include <algorithm>
#include <memory>
#include <mutex>

#include "pilotage/base/error.h"
#include "pilotage/base/parallel.h"

namespace pilotage {

std::vector<FrameMatch> match_flight(const std::filesystem::path& map, const std::vector<FlightFrame>& frames,
                                     const MatchOptions& options, FrameTruth truth, int threads,
                                     const Progress& progress) {
  std::vector<FrameMatch> matches(frames.size());
  std::vector<std::unique_ptr<MapReader>> readers(static_cast<std::size_t>(thread_count(threads)));
  std::mutex mutex;
  std::int64_t done = 0;
  const auto total = static_cast<std::int64_t>(frames.size());
  report_progress(progress, "matching", done, total);
  parallel_for(frames.size(), threads, [&](std::size_t index, int worker) {
    std::unique_ptr<MapReader>& reader = readers[static_cast<std::size_t>(worker)];
    if (!reader) reader = std::make_unique<MapReader>(map);
    const FlightFrame& frame = frames[index];
    matches[index] = match_frame(frame.path, frame.frame, frame.camera, *reader, options, truth);
    const std::lock_guard lock(mutex);
    report_progress(progress, "matching", ++done, total);
  });
  if (!matches.empty() && std::none_of(matches.begin(), matches.end(), [](const auto& m) { return m.readable(); })) {
    const std::string& problem = matches.front().problem;
    if (matches.size() == 1) throw DataError(problem);
    throw DataError("not one of " + std::to_string(matches.size()) + " frames can be read; the first: " + problem);
  }
  return matches;
}

}  // namespace pilotage
