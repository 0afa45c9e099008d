#include "pilotage/flightlog/match_flight.h"

#include <algorithm>

#include "pilotage/base/error.h"
#include "pilotage/mapdb/parallel_reading.h"

namespace pilotage {

std::vector<FrameMatch> match_flight(const std::function<MapReader()>& open_map, const std::vector<FlightFrame>& frames,
                                     const MatchOptions& options, FrameTruth truth, int threads,
                                     const Progress& progress) {
  std::vector<FrameMatch> matches(frames.size());
  for_each_with_reader(open_map, frames.size(), threads, "matching", progress,
                       [&](std::size_t index, MapReader& reader) {
                         const FlightFrame& frame = frames[index];
                         matches[index] = match_frame(frame.path, frame.frame, frame.camera, reader, options, truth);
                       });
  if (!matches.empty() && std::none_of(matches.begin(), matches.end(), [](const auto& m) { return m.readable(); })) {
    const std::string& problem = matches.front().problem;
    if (matches.size() == 1) throw DataError(problem);
    throw DataError("not one of " + std::to_string(matches.size()) + " frames can be read; the first: " + problem);
  }
  return matches;
}

}  // namespace pilotage
