#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "pilotage/mission/simulation.h"
#include "pilotage/simulate/fix_source.h"
#include "pilotage/simulate/simulated_mission.h"

namespace pilotage {

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

/// At a mark (SimulatedMission::marks_m). East and north; single precision, for there are flights times marks of them.
struct ErrorAtMark {
  Eigen::Vector2f error_m = Eigen::Vector2f::Zero();     ///< Estimated minus true position.
  Eigen::Vector2f off_line_m = Eigen::Vector2f::Zero();  ///< True place minus that of the line.
  /// Of the error, by the filter's covariance: χ² of two degrees of freedom when it is honest.
  float nees = 0;
};

/// One flight.
struct SimulatedFlight {
  /// Where k·σ of the filter first exceeds the limit (what the plan judges by), and where the true error does. Sample.
  std::optional<std::size_t> unsure_at;
  std::optional<std::size_t> off_at;
  std::optional<std::size_t> unaware_at;  ///< First place where it is off and the filter does not know.
  TryCounts fixes;
  FoundByP found;
  IntegrityCount integrity;  ///< Seconds flown without GNSS.
  std::vector<ErrorAtMark> marks;

  /// Within the limit all the way, and knew it.
  bool within() const { return !unsure_at && !off_at; }
  /// The sample where it was first either; the number of samples when it was not.
  std::size_t lost_at(std::size_t samples) const;
};

/// Flies the mission with everything drawn from `seed`, and with fixes from `fixes`; writes down where it flew when
/// there is a `track`. docs/methods/simulate.md.
SimulatedFlight fly_mission(const SimulatedMission& mission, std::uint64_t seed, bool map_is_off,
                            const FlightFixes& fixes, FlightTrack* track = nullptr);

}  // namespace pilotage
