#pragma once

#include <functional>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/flightlog/flight_frames.h"
#include "pilotage/flightlog/frame_match.h"
#include "pilotage/mapdb/map_reader.h"

namespace pilotage {

/// Matches the frames of a flight, each by itself, with one map reader, which `open_map` (called by several threads)
/// gives, for each of up to `threads` threads (0 = all cores); the answers in the order of the frames, the same for any
/// number of threads but for their milliseconds. Throws what `open_map` throws; DataError when no frame at all can be
/// read (with the first one's problem); Interrupted.
std::vector<FrameMatch> match_flight(const std::function<MapReader()>& open_map, const std::vector<FlightFrame>& frames,
                                     const MatchOptions& options, int threads, const Progress& progress);

/// Throws DataError with the first one's problem when there are frames and not one could be read.
void require_readable_frame(const std::vector<FrameMatch>& matches);

}  // namespace pilotage
