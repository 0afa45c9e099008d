#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "pilotage/ins/ins_span.h"
#include "pilotage/mission/mission.h"

namespace pilotage {

/// Speed over ground along a course that is held in a wind (east, north) by crabbing; at least 0.3 times the airspeed,
/// below which no one flies on.
double ground_speed_mps(double airspeed_mps, double azimuth_deg, const Eigen::Vector2d& wind_mps);

/// The steps from each sample of the route to the next in a wind. Neighbours of one leg, speed and length, whose course
/// differs by less than 0.1°, are flown by one step, so that a long route in many winds stays small.
class FlownSteps {
 public:
  FlownSteps() = default;
  /// `horizon_s` is what errors_ahead_m() looks ahead.
  FlownSteps(const Flight& flight, const Eigen::Vector2d& wind_mps, const InsErrorModel& model, double horizon_s = 0);

  std::size_t size() const { return index_.size(); }
  const InsStep& operator[](std::size_t i) const { return distinct_[index_[i]]; }
  const std::vector<InsStep>& distinct() const { return distinct_; }
  std::size_t index(std::size_t i) const { return index_[i]; }  ///< Into distinct().

  /// The position errors (k·σ) a horizon after sample i, flown straight on as it was reached, of states at the begin of
  /// a span that ends there.
  std::vector<double> errors_ahead_m(std::size_t i, const InsSpan& span, std::span<const InsState* const> states,
                                     double sigma_multiple) const;

 private:
  std::vector<InsStep> distinct_;
  std::vector<InsStep> horizons_;      ///< Of each distinct step.
  std::vector<PositionAhead> aheads_;  ///< The same; empty with an aiding velocity.
  std::vector<std::size_t> index_;
};

}  // namespace pilotage
