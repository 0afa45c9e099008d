#pragma once

#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/flightlog/flight_frames.h"
#include "pilotage/flightlog/frame_match.h"
#include "pilotage/mapdb/parallel_reading.h"

namespace pilotage {

/// Matches the frames of a flight, each by itself, on up to `threads` threads (0 = all cores); the answers in the order
/// of the frames, the same for any number of threads but for their milliseconds. Throws what `open_maps` throws;
/// DataError when no frame at all can be read (with the first one's problem); Interrupted.
std::vector<FrameMatch> match_flight(const OpenMaps& open_maps, const std::vector<FlightFrame>& frames,
                                     const MatchOptions& options, int threads, const Progress& progress);

/// Throws DataError with the first one's problem when there are frames and not one could be read.
void require_readable_frame(const std::vector<FrameMatch>& matches);

}  // namespace pilotage
