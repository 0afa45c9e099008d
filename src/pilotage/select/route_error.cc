#include "pilotage/select/route_error.h"

#include <algorithm>
#include <limits>
#include <optional>

#include "pilotage/ins/ins_error_model.h"
#include "pilotage/ins/ins_state.h"
#include "pilotage/mission/flight_time.h"

namespace pilotage {
namespace {

// An aircraft at one sample of the plan, and what is known of its error there. A value: copies fly on their own.
struct InsAtSample {
  std::size_t sample = 0;
  InsState state;
  double last_fix_s = -std::numeric_limits<double>::infinity();
};

InsAtSample ins_at_start(const Mission& mission, const InsErrorModel& model) {
  const FlightSample& first = mission.flight.samples.front();
  return {0, initial_ins_state(model, first.azimuth_deg, first.speed_mps)};
}

double step_s(const Mission& mission, std::size_t from) {
  return step_time_s(mission.flight.samples[from], mission.flight.samples[from + 1]);
}

void hold_with_gnss(InsAtSample& aircraft, const Mission& mission, const InsErrorModel& model) {
  const FlightSample& at = mission.flight.samples[aircraft.sample];
  aircraft.state = hold_with_gnss(aircraft.state, at.azimuth_deg, at.speed_mps, model);
}

void fly_one_sample(InsAtSample& aircraft, const Mission& mission, const GnssAvailability& gnss,
                    const InsErrorModel& model) {
  const FlightSample& from = mission.flight.samples[aircraft.sample];
  aircraft.state = propagate(aircraft.state, step_s(mission, aircraft.sample), from.azimuth_deg, from.speed_mps, model);
  ++aircraft.sample;
  if (gnss.over_step[aircraft.sample - 1]) hold_with_gnss(aircraft, mission, model);
}

// What GNSS and the ground give at a sample.
void take_position(InsAtSample& aircraft, const Mission& mission, const GnssAvailability& gnss,
                   const std::vector<bool>& matchable, const InsErrorModel& model, double fix_interval_s) {
  if (gnss.at_sample[aircraft.sample]) hold_with_gnss(aircraft, mission, model);
  if (!matchable[aircraft.sample] || !(aircraft.state.time_s - aircraft.last_fix_s >= fix_interval_s)) return;
  aircraft.state = update_with_fix(aircraft.state, model.fix_sigma_m);
  aircraft.last_fix_s = aircraft.state.time_s;
}

// The stretches without matchable ground and GNSS, as gaps between fixes.
std::vector<RouteGap> find_gaps(const Mission& mission, const GnssAvailability& gnss,
                                const std::vector<bool>& matchable, const std::vector<ErrorSample>& profile,
                                double max_error_m) {
  std::vector<RouteGap> gaps;
  const std::size_t count = mission.flight.samples.size();
  const auto is_known = [&](std::size_t i) { return matchable[i] || gnss.at_sample[i]; };
  for (std::size_t i = 0; i < count;) {
    if (is_known(i)) {
      ++i;
      continue;
    }
    const std::size_t first = i == 0 || gnss.over_step[i - 1] ? i : i - 1;
    while (i < count && !is_known(i)) ++i;
    const std::size_t last = std::min(i, count - 1);
    RouteGap gap;
    gap.leg = mission.flight.samples[first].leg;
    gap.from_distance_m = mission.flight.samples[first].distance_m;
    gap.to_distance_m = mission.flight.samples[last].distance_m;
    for (std::size_t k = first; k < last; ++k) gap.duration_s += step_s(mission, k);
    for (std::size_t k = first; k <= last; ++k) gap.error_m = std::max(gap.error_m, profile[k].error_m);
    gap.within_limit = gap.error_m <= max_error_m;
    // Samples at a vertex stand twice; a stretch of no length is no gap.
    if (gap.to_distance_m > gap.from_distance_m) gaps.push_back(gap);
  }
  return gaps;
}

std::vector<LegStatus> leg_statuses(const Mission& mission, const std::vector<ErrorSample>& profile,
                                    double max_error_m) {
  std::vector<LegStatus> legs;
  std::vector<double> matchable_m(mission.flight.route.legs.size(), 0.0);
  for (std::size_t i = 0; i < mission.flight.route.legs.size(); ++i) {
    legs.push_back({static_cast<int>(i), mission.flight.route.legs[i].length_m, 0, 0, true});
  }
  for (std::size_t i = 0; i < profile.size(); ++i) {
    LegStatus& leg = legs[static_cast<std::size_t>(mission.flight.samples[i].leg)];
    leg.max_error_m = std::max(leg.max_error_m, profile[i].error_m);
    const bool same_leg = i + 1 < profile.size() && mission.flight.samples[i + 1].leg == leg.leg;
    if (same_leg && profile[i].matchable && profile[i + 1].matchable) {
      matchable_m[static_cast<std::size_t>(leg.leg)] += profile[i + 1].distance_m - profile[i].distance_m;
    }
  }
  for (LegStatus& leg : legs) {
    leg.within_limit = leg.max_error_m <= max_error_m;
    if (leg.length_m > 0) {
      leg.matchable_fraction = std::min(1.0, matchable_m[static_cast<std::size_t>(leg.leg)] / leg.length_m);
    }
  }
  return legs;
}

}  // namespace

RouteError predict_route_error(const Mission& mission, const GnssAvailability& gnss, const std::vector<bool>& matchable,
                               double max_error_m, double fix_interval_s) {
  const InsErrorModel model = make_error_model(mission.flight.ins, mission.flight.conditions);
  RouteError result;
  InsAtSample aircraft = ins_at_start(mission, model);
  while (true) {
    const std::size_t i = aircraft.sample;
    const double error_m = position_error_m(aircraft.state, model.sigma_multiple);
    result.profile.push_back({mission.flight.samples[i].distance_m, error_m, matchable[i]});
    result.within_limit = result.within_limit && error_m <= max_error_m;
    take_position(aircraft, mission, gnss, matchable, model, fix_interval_s);
    if (i + 1 == mission.flight.samples.size()) break;
    fly_one_sample(aircraft, mission, gnss, model);
  }
  result.gaps = find_gaps(mission, gnss, matchable, result.profile, max_error_m);
  result.legs = leg_statuses(mission, result.profile, max_error_m);
  double matchable_m = 0;
  double total_m = 0;
  for (const LegStatus& leg : result.legs) {
    matchable_m += leg.matchable_fraction * leg.length_m;
    total_m += leg.length_m;
  }
  result.matchable_fraction = total_m > 0 ? matchable_m / total_m : 0;
  return result;
}

RouteError predict_route_error(const Mission& mission, const std::vector<bool>& matchable, double max_error_m,
                               double fix_interval_s) {
  return predict_route_error(mission, gnss_availability(mission.flight), matchable, max_error_m, fix_interval_s);
}

std::vector<double> largest_errors_of_losses(const Mission& mission, const std::vector<std::size_t>& losses,
                                             const std::vector<bool>& matchable, double fix_interval_s) {
  const InsErrorModel model = make_error_model(mission.flight.ins, mission.flight.conditions);
  const GnssAvailability had = gnss_everywhere(mission.flight, true);
  const GnssAvailability lost = gnss_everywhere(mission.flight, false);
  const std::size_t count = mission.flight.samples.size();
  const auto error_m = [&](const InsAtSample& at) { return position_error_m(at.state, model.sigma_multiple); };
  std::vector<double> largest_m;
  InsAtSample with_gnss = ins_at_start(mission, model);
  double with_gnss_m = error_m(with_gnss);
  for (const std::size_t loss : losses) {
    while (with_gnss.sample < loss) {
      take_position(with_gnss, mission, had, matchable, model, fix_interval_s);
      fly_one_sample(with_gnss, mission, had, model);
      with_gnss_m = std::max(with_gnss_m, error_m(with_gnss));
    }
    InsAtSample aircraft = with_gnss;
    double most_m = with_gnss_m;
    while (aircraft.sample + 1 < count) {
      take_position(aircraft, mission, lost, matchable, model, fix_interval_s);
      fly_one_sample(aircraft, mission, lost, model);
      most_m = std::max(most_m, error_m(aircraft));
    }
    largest_m.push_back(most_m);
  }
  return largest_m;
}

std::vector<std::size_t> fewest_fix_samples(const Mission& mission, const std::vector<bool>& matchable,
                                            double max_error_m) {
  const InsErrorModel model = make_error_model(mission.flight.ins, mission.flight.conditions);
  const GnssAvailability gnss = gnss_availability(mission.flight);
  const std::size_t count = mission.flight.samples.size();
  std::vector<std::size_t> fixes;
  InsAtSample aircraft = ins_at_start(mission, model);
  std::optional<InsAtSample> last_chance;  // at the last matchable sample flown over since the last fix, or GNSS
  while (aircraft.sample + 1 < count) {
    fly_one_sample(aircraft, mission, gnss, model);
    const bool over_limit = position_error_m(aircraft.state, model.sigma_multiple) > max_error_m;
    const bool has_gnss = gnss.at_sample[aircraft.sample];
    const bool can_fix = matchable[aircraft.sample] && !has_gnss;
    if (over_limit && (last_chance || can_fix)) {
      aircraft = last_chance.value_or(aircraft);
      aircraft.state = update_with_fix(aircraft.state, model.fix_sigma_m);
      fixes.push_back(aircraft.sample);
      last_chance.reset();
    } else if (has_gnss) {
      hold_with_gnss(aircraft, mission, model);
      last_chance.reset();
    } else if (can_fix) {
      last_chance = aircraft;
    }
  }
  return fixes;
}

}  // namespace pilotage
