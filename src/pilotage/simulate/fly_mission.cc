#include "pilotage/simulate/fly_mission.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pilotage/base/angle.h"
#include "pilotage/geo/position_covariance.h"
#include "pilotage/match/position_measurement.h"
#include "pilotage/mission/tile_under.h"
#include "pilotage/navigate/navigation_filter.h"
#include "pilotage/select/flown_steps.h"
#include "pilotage/simulate/flight_streams.h"

namespace pilotage {
namespace {

/// Time in which the aircraft takes back 63 % of the way by which its navigation finds it off the line.
constexpr double kSteering_s = 10;
/// Steps whose noise can be drawn, as they are flown in a wind.
class DrawnSteps {
 public:
  explicit DrawnSteps(FlownSteps steps) : steps_(std::move(steps)) {
    for (const InsStep& step : steps_.distinct()) drawn_.emplace_back(step);
  }
  std::size_t size() const { return steps_.size(); }
  const DrawnStep& operator[](std::size_t i) const { return drawn_[steps_.index(i)]; }

 private:
  FlownSteps steps_;
  std::vector<DrawnStep> drawn_;
};

/// A flight under way.
class Flying {
 public:
  Flying(const SimulatedMission& mission, bool map_is_off, const Eigen::Vector2d& wind_mps, std::uint64_t seed,
         const FlightFixes& fixes)
      : mission_(mission),
        samples_(mission.path.mission->flight.samples),
        errors_(flight_stream(seed, FlightStream::kErrors)),
        fixes_(fixes),
        wind_mps_(wind_mps),
        drawn_(draw_errors(mission.path.model, map_is_off, samples_.front().azimuth_deg, samples_.front().speed_mps,
                           errors_)) {}

  SimulatedFlight fly(const DrawnSteps& steps, FlightTrack* track) {
    std::size_t attempt = 0;
    std::size_t mark = 0;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      judge(i);
      if (i > 0 && !mission_.path.gnss.over_step[i - 1]) look(steps[i - 1].step.dt_s);
      if (mission_.path.gnss.at_sample[i]) hold();
      while (mark < mission_.marks_m.size() && samples_[i].distance_m >= mission_.marks_m[mark] - 1e-6) {
        flight_.marks.push_back(error_now());
        ++mark;
      }
      for (; attempt < mission_.attempts.size() && mission_.attempts[attempt].sample <= i; ++attempt) {
        if (mission_.attempts[attempt].sample == i) try_fix(mission_.attempts[attempt]);
      }
      if (track != nullptr) {
        track->true_off_line_m.push_back(off_line_m());
        track->believed_off_line_m.push_back(beside_m_);
      }
      if (i >= steps.size()) continue;
      fly_step(drawn_, steps[i], errors_);
      time_s_ += steps[i].step.dt_s;
      beside_m_ *= std::exp(-steps[i].step.dt_s / kSteering_s);
      if (mission_.path.gnss.over_step[i]) hold();
    }
    return flight_;
  }

 private:
  void hold() {
    hold_by_gnss(drawn_, mission_.path.model, errors_);
    last_taken_s_ = time_s_;
    flight_.integrity.end_stretch();
  }

  ErrorAtMark error_now() const {
    return {drawn_.position_error_m().cast<float>(), off_line_m().cast<float>(),
            static_cast<float>(mahalanobis_squared(drawn_.position_error_m(), drawn_.position_covariance_m2()))};
  }

  /// Where it really is: how far the navigation finds the aircraft beside the line, less how far it errs.
  Eigen::Vector2d off_line_m() const { return beside_m_ - drawn_.position_error_m(); }

  void judge(std::size_t i) {
    const double limit_m = mission_.path.max_error_m;
    const double believed_m = mission_.path.model.sigma_multiple * largest_sigma_m(drawn_.position_covariance_m2());
    const bool unsure = !(believed_m <= limit_m);
    const bool off = !(drawn_.position_error_m().norm() <= limit_m);
    if (unsure && !flight_.unsure_at) flight_.unsure_at = i;
    if (off && !flight_.off_at) flight_.off_at = i;
    if (off && !flight_.unsure_at && !flight_.unaware_at) flight_.unaware_at = i;
  }

  /// What the step that led here was flown by: its end, where the error is largest.
  void look(double dt_s) {
    flight_.integrity.look(dt_s, largest_sigma_m(drawn_.position_covariance_m2()), drawn_.position_error_m().norm(),
                           mission_.path.max_error_m);
  }

  /// The tile really below.
  std::optional<std::size_t> tile_below(std::size_t sample) const {
    FlightSample there = samples_[sample];
    there.point_map_m += mission_.map_from_en[sample] * off_line_m();
    return tile_under(*mission_.path.mission, there);
  }

  void try_fix(const FixAttempt& attempt) {
    // Beyond its limit the plan counts a flight as lost, and P was not fitted for priors so wide.
    if (flight_.unsure_at) return;
    if (time_s_ - fix_time_s_ < mission_.tries.interval_s - 1e-9) return;
    ++flight_.fixes.tries;
    std::optional<std::size_t> below = tile_below(attempt.sample);
    if (below && !mission_.tiles[*below].stored) below.reset();
    const TriedFix tried = fixes_(try_of(attempt, below));
    const bool right = tried.fix && tried.fix->right;
    if (!tried.has_frame) {
      ++flight_.fixes.no_frame;
    } else if (below) {
      flight_.found.add(mission_.tiles[*below].mean_p, right);
      if (!right) ++flight_.fixes.missed;
    } else if (!right) {
      ++(mission_.tiles[attempt.tile].stored ? flight_.fixes.off_line : flight_.fixes.not_stored);
    }
    if (tried.fix) offer(*tried.fix);
  }

  FixTry try_of(const FixAttempt& attempt, const std::optional<std::size_t>& below) const {
    const FlightSample& at = samples_[attempt.sample];
    const double azimuth_rad = at.azimuth_deg * kRadPerDeg;
    FixTry tried;
    tried.sample = attempt.sample;
    tried.window = attempt.window;
    tried.below = below;
    if (below) tried.below_p = mission_.tiles[*below].mean_p;
    tried.time_s = time_s_;
    tried.off_line_m = off_line_m();
    tried.over_ground_mps = ground_speed_mps(at.speed_mps, at.azimuth_deg, wind_mps_) *
                            Eigen::Vector2d(std::sin(azimuth_rad), std::cos(azimuth_rad));
    const Eigen::Vector2d through_air_mps = tried.over_ground_mps - wind_mps_;
    tried.heading_deg = std::atan2(through_air_mps.x(), through_air_mps.y()) / kRadPerDeg;
    tried.drawn = &drawn_;
    return tried;
  }

  /// The filter is offered a fix.
  void offer(const OfferedFix& fix) {
    const Eigen::Vector2d& innovation_m = fix.innovation_m;
    const Eigen::Matrix2d covariance = innovation_covariance(drawn_, fix.noise_m2);
    if (!(mahalanobis_squared(innovation_m, covariance) <= kInnovationGateChiSquared)) {
      ++flight_.fixes.refused;
      const bool same =
          refusals_ > 0 && mahalanobis_squared(innovation_m - refused_m_, covariance) <= kInnovationGateChiSquared;
      refusals_ = same ? refusals_ + 1 : 1;
      refused_m_ = innovation_m;
      if (refusals_ < NavigationOptions{}.refusals_to_reset) return;
      doubt(innovation_m);
      ++flight_.fixes.resets;
    }
    const Eigen::Vector2d before_m = drawn_.position_error_m();
    take_fix(drawn_, innovation_m, fix.noise_m2);
    beside_m_ += drawn_.position_error_m() - before_m;
    fix_time_s_ = last_taken_s_ = time_s_;
    flight_.integrity.end_stretch();
    refusals_ = 0;
    ++(fix.right ? flight_.fixes.right : flight_.fixes.false_taken);
  }

  /// As the filter on board: position and velocity may be off by what refused fixes say.
  void doubt(const Eigen::Vector2d& innovation_m) {
    const double since_s = std::max(1.0, time_s_ - last_taken_s_);
    InsState::Covariance& covariance = drawn_.believed.covariance;
    covariance.block<2, 2>(InsState::kPosition, InsState::kPosition).diagonal().array() += innovation_m.squaredNorm();
    if (!mission_.path.model.is_odometry()) {
      covariance.block<2, 2>(InsState::kVelocity, InsState::kVelocity).diagonal().array() +=
          innovation_m.squaredNorm() / (since_s * since_s);
    }
  }

  const SimulatedMission& mission_;
  const std::vector<FlightSample>& samples_;
  Random errors_;
  const FlightFixes& fixes_;
  Eigen::Vector2d wind_mps_;
  DrawnErrors drawn_;
  SimulatedFlight flight_;
  double time_s_ = 0;
  double fix_time_s_ = -std::numeric_limits<double>::infinity();
  double last_taken_s_ = 0;
  Eigen::Vector2d beside_m_ = Eigen::Vector2d::Zero();  ///< How far the navigation finds the aircraft off the line.
  Eigen::Vector2d refused_m_ = Eigen::Vector2d::Zero();
  int refusals_ = 0;
};

}  // namespace

void FoundByP::add(double p, bool right) {
  Bin& bin = bins[static_cast<std::size_t>(std::clamp(p * kBins, 0.0, kBins - 1.0))];
  ++bin.tries;
  bin.right += right ? 1 : 0;
  bin.sum_p += p;
}

std::size_t SimulatedFlight::lost_at(std::size_t samples) const {
  return std::min(unsure_at.value_or(samples), off_at.value_or(samples));
}

SimulatedFlight fly_mission(const SimulatedMission& mission, std::uint64_t seed, bool map_is_off,
                            const FlightFixes& fixes, FlightTrack* track) {
  Random random = flight_stream(seed, FlightStream::kWind);
  const double east_mps = mission.conditions.wind_sigma_mps * random.normal();
  const double north_mps = mission.conditions.wind_sigma_mps * random.normal();
  const Eigen::Vector2d wind_mps(east_mps, north_mps);
  const DrawnSteps steps(FlownSteps(mission.path.mission->flight, wind_mps, mission.path.model));
  return Flying(mission, map_is_off, wind_mps, seed, fixes).fly(steps, track);
}

}  // namespace pilotage
