#include "pilotage/select/flown_steps.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "pilotage/base/angle.h"

namespace pilotage {
namespace {

constexpr double kLeastShareOfAirspeed = 0.3;
constexpr double kSameLength_m = 1e-4;
constexpr double kSameCourse_deg = 0.1;

}  // namespace

double ground_speed_mps(double airspeed_mps, double azimuth_deg, const Eigen::Vector2d& wind_mps) {
  const double azimuth_rad = azimuth_deg * kRadPerDeg;
  const Eigen::Vector2d along(std::sin(azimuth_rad), std::cos(azimuth_rad));
  const double cross = wind_mps.dot(Eigen::Vector2d(along.y(), -along.x()));
  const double ahead = std::sqrt(std::max(0.0, airspeed_mps * airspeed_mps - cross * cross));
  return std::max(kLeastShareOfAirspeed * airspeed_mps, ahead + wind_mps.dot(along));
}

FlownSteps::FlownSteps(const Flight& flight, const Eigen::Vector2d& wind_mps, const InsErrorModel& model,
                       double horizon_s) {
  const std::vector<FlightSample>& samples = flight.samples;
  std::size_t first = 0;  // of those that fly the last step made
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
    const auto way_m = [&](std::size_t k) { return samples[k + 1].distance_m - samples[k].distance_m; };
    const bool alike =
        i > 0 && samples[i].leg == samples[first].leg && samples[i].speed_mps == samples[first].speed_mps &&
        std::abs(way_m(i) - way_m(first)) < kSameLength_m &&
        std::abs(std::remainder(samples[i].azimuth_deg - samples[first].azimuth_deg, 360)) < kSameCourse_deg;
    if (!alike) {
      first = i;
      const FlightSample& at = samples[i];
      const double speed_mps = ground_speed_mps(at.speed_mps, at.azimuth_deg, wind_mps);
      distinct_.push_back(make_ins_step(way_m(i) / speed_mps, at.azimuth_deg, speed_mps, model));
    }
    index_.push_back(distinct_.size() - 1);
  }
  if (horizon_s == 0) return;
  for (const InsStep& step : distinct_) {
    horizons_.push_back(make_ins_step(horizon_s, step.heading_deg, step.speed_mps, model));
    if (!step.aided) aheads_.emplace_back(horizons_.back());
  }
}

std::vector<double> FlownSteps::errors_ahead_m(std::size_t i, const InsSpan& span,
                                               std::span<const InsState* const> states, double sigma_multiple) const {
  const std::size_t flown = index_.empty() ? 0 : index_[i > 0 ? i - 1 : 0];
  std::optional<PositionAhead> ahead;
  if (!aheads_.empty()) ahead = span.position_after(aheads_[flown]);
  std::vector<double> errors_m;
  for (const InsState* const state : states) {
    errors_m.push_back(ahead ? position_error_m(ahead->covariance_m2(state->covariance), sigma_multiple)
                             : position_error_m(propagate(span.end_of(*state), horizons_[flown]), sigma_multiple));
  }
  return errors_m;
}

}  // namespace pilotage
