#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pilotage/base/nan.h"
#include "pilotage/simulate/drawn_errors.h"
#include "pilotage/simulate/simulate_options.h"
#include "pilotage/simulate/simulated_mission.h"

namespace pilotage {

/// A try to fix: where a flight truly is when it takes a frame, and what its filter believes.
struct FixTry {
  std::size_t sample = 0;                 ///< Of the route: the place on the line.
  std::int64_t window = 0;                ///< FixAttempt::window.
  std::optional<std::size_t> below;       ///< The stored tile that is truly below; nothing where none is.
  double below_p = kNaN;                  ///< Its P over all levels of the place.
  double time_s = 0;                      ///< Since the start.
  Eigen::Vector2d off_line_m{0, 0};       ///< From the place on the line to the aircraft, east and north.
  Eigen::Vector2d over_ground_mps{0, 0};  ///< Velocity, east and north.
  double heading_deg = 0;                 ///< Of the nose: the course and the crab angle.
  const DrawnErrors* drawn = nullptr;     ///< True errors and the filter's covariance; never null.
};

/// A fix that the filter is offered.
struct OfferedFix {
  Eigen::Vector2d innovation_m{0, 0};                      ///< Predicted minus measured, east and north, by the map.
  Eigen::Matrix2d noise_m2 = Eigen::Matrix2d::Identity();  ///< Of the measurement, without the map's own error.
  bool right = false;
};

struct TriedFix {
  bool has_frame = true;  ///< False: no frame came, and P has nothing to do with it.
  std::optional<OfferedFix> fix;
};

/// Answers the tries of one flight, in the order of the flight.
using FlightFixes = std::function<TriedFix(const FixTry&)>;

/// Where fixes of simulated flights come from.
struct FixSource {
  /// Fixes of flight number `flight`, by random numbers from `seed` alone. No two flights under way have the same
  /// `worker`, a number below thread_count(): what cannot be shared by threads is kept for each. `go_on` may be empty;
  /// when it returns false, a long answer throws Interrupted.
  std::function<FlightFixes(std::size_t flight, std::uint64_t seed, int worker, const std::function<bool()>& go_on)>
      begin_flight;
  /// The error of the map's georeference is drawn (FlightConditions::map_sigma_m). False: it is in what frames show,
  /// and the filter alone reckons with that.
  bool draws_map_error = true;
  std::vector<std::string> notes;          ///< What to know of the result, as sentences.
  std::vector<std::string> not_simulated;  ///< What was left out, as sentences.
};

/// Whether a fix comes is drawn by the P of the tile below (docs/methods/simulate.md). `mission` and `options` must
/// outlive the source.
FixSource drawn_fixes(const SimulatedMission& mission, const SimulateOptions& options);

/// No try gives a fix: the inertial system alone.
FixSource no_fixes();

}  // namespace pilotage
