#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "pilotage/simulate/fix_source.h"
#include "pilotage/simulate/simulated_mission.h"

namespace pilotage {

/// What became of a flight's tries to fix.
struct TriedFixes {
  std::int64_t tries = 0;        ///< While the flight knew itself within the limit, over ground of stored tiles or not.
  std::int64_t right = 0;        ///< Right fixes that were taken.
  std::int64_t missed = 0;       ///< Over a stored tile, and no fix came.
  std::int64_t not_stored = 0;   ///< Over ground that is not stored, where the line leads over none either.
  std::int64_t off_line = 0;     ///< The same, where the line leads over a stored tile: the aircraft was beside it.
  std::int64_t no_frame = 0;     ///< No frame came: dropped, or of ground beyond the imagery that is looked at.
  std::int64_t false_taken = 0;  ///< False fixes that passed the gate.
  std::int64_t refused = 0;      ///< False and right fixes that the gate refused.
  std::int64_t resets = 0;       ///< Fixes believed after refusals that said the same.
};

/// Tries with a frame over stored tiles by the P that their table has, in ten equal bins: how often a right fix was
/// found, whatever the filter made of it.
struct FoundByP {
  static constexpr std::size_t kBins = 10;
  struct Bin {
    std::int64_t tries = 0;
    std::int64_t right = 0;
    double sum_p = 0;
  };
  std::array<Bin, kBins> bins;

  void add(double p, bool right);
};

/// At a mark (SimulatedMission::marks_m).
struct ErrorAtMark {
  double error_m = 0;  ///< True error of the position.
  double nees = 0;     ///< Normalised by the filter's covariance: χ² of two degrees of freedom when it is honest.
};

/// One flight.
struct SimulatedFlight {
  /// Where k·σ of the filter first exceeds the limit (what the plan judges by), and where the true error does. Sample.
  std::optional<std::size_t> unsure_at;
  std::optional<std::size_t> off_at;
  std::optional<std::size_t> unaware_at;  ///< First place where it is off and the filter does not know.
  TriedFixes fixes;
  FoundByP found;
  std::vector<ErrorAtMark> marks;

  /// Within the limit all the way, and knew it.
  bool within() const { return !unsure_at && !off_at; }
  /// The sample where it was first either; the number of samples when it was not.
  std::size_t lost_at(std::size_t samples) const;
};

/// Flies the mission with everything drawn from `seed`, and with fixes from `fixes`. docs/methods/simulate.md.
SimulatedFlight fly_mission(const SimulatedMission& mission, const SimulateOptions& options, std::uint64_t seed,
                            const MapError& map, const FlightFixes& fixes);

}  // namespace pilotage
