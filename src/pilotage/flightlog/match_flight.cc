#include "pilotage/flightlog/match_flight.h"

#include <algorithm>
#include <cstdint>
#include <mutex>
#include <string_view>

#include "pilotage/base/error.h"

namespace pilotage {

void require_readable_frame(const std::vector<FrameMatch>& matches) {
  if (matches.empty()) return;
  if (std::any_of(matches.begin(), matches.end(), [](const auto& m) { return m.readable(); })) return;
  const std::string& problem = matches.front().problem;
  if (matches.size() == 1) throw DataError(problem);
  throw DataError("not one of " + std::to_string(matches.size()) + " frames can be read; the first: " + problem);
}

std::vector<FrameMatch> match_flight(const OpenMaps& open_maps, const std::vector<FlightFrame>& frames,
                                     const MatchOptions& options, int threads, const Progress& progress) {
  std::vector<FrameMatch> matches(frames.size());
  // A single frame may take long: it asks, too, with what was said last.
  std::mutex mutex;
  std::int64_t done = 0;
  const auto total = static_cast<std::int64_t>(frames.size());
  const auto report = [&](std::int64_t now_done) {
    const std::lock_guard lock(mutex);
    done = std::max(done, now_done);
    return !progress || progress("matching", done, total);
  };
  for_each_with_readers(
      open_maps, frames.size(), threads, "matching",
      [&](std::string_view, std::int64_t now_done, std::int64_t) { return report(now_done); },
      [&](std::size_t index, std::span<MapReader> maps) {
        const FlightFrame& frame = frames[index];
        matches[index] = match_frame(frame.path, frame.frame, frame.camera, maps, options, [&] { return report(0); });
      });
  require_readable_frame(matches);
  return matches;
}

}  // namespace pilotage
