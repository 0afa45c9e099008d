#pragma once

#include <cstdint>

#include "pilotage/base/random.h"

namespace pilotage {

/// Streams of random numbers of one flight, so that what one draws does not move what another does.
enum class FlightStream : std::uint64_t { kErrors, kFixes, kWind, kLevel, kWindows, kFrames };

inline std::uint64_t flight_stream_seed(std::uint64_t flight_seed, FlightStream which) {
  return derive_seed(flight_seed, static_cast<std::uint64_t>(which));
}

inline Random flight_stream(std::uint64_t flight_seed, FlightStream which) {
  return Random(flight_stream_seed(flight_seed, which));
}

}  // namespace pilotage
