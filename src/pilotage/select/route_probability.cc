#include "pilotage/select/route_probability.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <tuple>

#include "pilotage/base/nan.h"
#include "pilotage/ins/drift.h"

namespace pilotage {
namespace {

constexpr double kLeastShare = 1e-9;
constexpr double kSameError = 0.02;
constexpr std::size_t kMostGroups = 12;

double total_probability(const std::vector<FlightBranch>& branches) {
  double total = 0;
  for (const FlightBranch& branch : branches) total += branch.probability;
  return total;
}

// Takes out the branches beyond the limit, and those that hold next to nothing.
void lose_flights(const FlightPath& path, std::size_t sample, FlightStretch& stretch) {
  const double least = kLeastShare * total_probability(stretch.branches);
  std::erase_if(stretch.branches, [&](const FlightBranch& branch) {
    const bool beyond = !(position_error_m(branch.state, path.model.sigma_multiple) <= path.max_error_m);
    if (beyond) stretch.losses.emplace_back(branch.fix_sample, sample);
    return beyond || branch.probability <= least;
  });
}

// A branch just after a fix, and its error a horizon later.
struct FixedBranch {
  FlightBranch branch;
  double error_m = 0;
};

bool same_draw(const FlightBranch& a, const FlightBranch& b) {
  return a.u_low == b.u_low && a.u_high == b.u_high;
}

// Where the groups end when errors, ascending, differ by at most `share` within one.
std::vector<std::size_t> group_ends(const std::vector<FixedBranch>& fixed, double share) {
  std::vector<std::size_t> ends;
  for (std::size_t i = 0; i < fixed.size();) {
    const FixedBranch& first = fixed[i];
    const double most_m = first.error_m * (1 + share);
    for (++i; i < fixed.size() && fixed[i].error_m <= most_m && same_draw(fixed[i].branch, first.branch);) ++i;
    ends.push_back(i);
  }
  return ends;
}

std::vector<FlightBranch> merge_alike(const FlightPath& path, std::vector<FixedBranch> fixed) {
  const InsState& one = fixed.front().branch.state;
  const InsStep horizon = make_ins_step(path.horizon_s, one.heading_deg, one.speed_mps, path.model);
  for (FixedBranch& after : fixed) {
    after.error_m = position_error_m(propagate(after.branch.state, horizon), path.model.sigma_multiple);
  }
  std::stable_sort(fixed.begin(), fixed.end(), [](const auto& a, const auto& b) {
    return std::tuple(a.branch.u_low, a.branch.u_high, a.error_m) <
           std::tuple(b.branch.u_low, b.branch.u_high, b.error_m);
  });
  double share = kSameError;
  std::vector<std::size_t> ends = group_ends(fixed, share);
  while (ends.size() > kMostGroups && share < 1) ends = group_ends(fixed, share *= 2);
  std::vector<FlightBranch> merged;
  std::size_t i = 0;
  for (const std::size_t end : ends) {
    double total = 0;
    for (std::size_t k = i; k < end; ++k) total += fixed[k].branch.probability;
    FlightBranch group = fixed[i].branch;
    group.probability = total;
    group.state.covariance.setZero();
    for (; i < end; ++i) {
      group.state.covariance += fixed[i].branch.probability / total * fixed[i].branch.state.covariance;
    }
    merged.push_back(group);
  }
  return merged;
}

// Parts of all branches get a fix at the sample and become new branches.
void take_fix(const FlightPath& path, const RouteChances& chances, std::size_t sample, FlightStretch& stretch) {
  const double p = chances.p[sample];
  if (!(p > 0)) return;
  std::vector<FixedBranch> fixed;
  for (FlightBranch& branch : stretch.branches) {
    if (branch.state.time_s - branch.fix_time_s < chances.fix_interval_s - 1e-9) continue;
    if (branch.window != chances.window[sample]) {
      branch.window = chances.window[sample];
      branch.u_low = 0;
      branch.u_high = 1;
    }
    const double share = std::clamp((p - branch.u_low) / (branch.u_high - branch.u_low), 0.0, 1.0);
    if (share > 0) {
      if (!branch.fixed_on_stretch) stretch.p_fix += share * branch.probability;
      FlightBranch after = branch;
      after.fixed_on_stretch = true;
      after.fix_sample = sample;
      after.fix_time_s = branch.state.time_s;
      after.probability *= share;
      after.u_high = std::min(branch.u_high, p);
      after.state = update_with_fix(branch.state, path.model.fix_sigma_m);
      fixed.push_back({after});
    }
    branch.probability *= 1 - share;
    branch.u_low = std::max(branch.u_low, p);
  }
  std::erase_if(stretch.branches, [](const FlightBranch& branch) { return branch.probability <= 0; });
  if (fixed.empty()) return;
  for (const FlightBranch& group : merge_alike(path, std::move(fixed))) {
    stretch.branches.push_back(group);
    stretch.fixes.push_back(group);
  }
}

void take_gnss(const FlightPath& path, std::size_t sample, std::vector<FlightBranch>& branches) {
  for (FlightBranch& branch : branches) {
    branch.fix_sample = sample;
    branch.state = held_with_gnss(path, sample, branch.state);
  }
}

std::optional<WorstStretch> worst_stretch(const FlightPath& path, const std::vector<double>& p_within_limit,
                                          const std::vector<std::pair<std::size_t, std::size_t>>& losses) {
  std::optional<WorstStretch> worst;
  const std::vector<FlightSample>& samples = path.mission->flight.samples;
  for (const auto& [from, to] : losses) {
    const double before = from == 0 && to == 0 ? 1 : p_within_limit[from];
    const double loss = before - p_within_limit[to];
    if (worst && loss <= worst->p_first_excess) continue;
    worst = WorstStretch{samples[from].leg, samples[from].distance_m, samples[to].distance_m, loss};
  }
  return worst;
}

}  // namespace

FlightPath make_flight_path(const Mission& mission, double max_error_m) {
  FlightPath path;
  path.mission = &mission;
  path.model = make_ins_error_model(mission.flight.ins);
  path.max_error_m = max_error_m;
  const double reach_s = longest_bridgeable_gap_s(path.model, mission.flight.samples.front().speed_mps, max_error_m,
                                                  path.model.sigma_multiple, path.model.fix_sigma_m);
  path.horizon_s = std::clamp(reach_s, 1.0, 600.0);
  for (std::size_t i = 0; i + 1 < mission.flight.samples.size(); ++i) {
    const FlightSample& from = mission.flight.samples[i];
    const double step_s = (mission.flight.samples[i + 1].distance_m - from.distance_m) / from.speed_mps;
    path.steps.push_back(make_ins_step(step_s, from.azimuth_deg, from.speed_mps, path.model));
  }
  path.gnss = gnss_availability(mission.flight);
  return path;
}

InsState held_with_gnss(const FlightPath& path, std::size_t sample, const InsState& state) {
  const FlightSample& at = path.mission->flight.samples[sample];
  return hold_with_gnss(state, at.azimuth_deg, at.speed_mps, path.model);
}

std::vector<FlightBranch> first_branches(const FlightPath& path) {
  const FlightSample& first = path.mission->flight.samples.front();
  return {{0, 1, initial_ins_state(path.model, first.azimuth_deg, first.speed_mps)}};
}

FlightStretch fly_stretch(const FlightPath& path, const RouteChances& chances, std::size_t begin, std::size_t end,
                          std::vector<FlightBranch> branches) {
  assert(end <= chances.p.size() && chances.p.size() == path.mission->flight.samples.size());
  FlightStretch stretch;
  stretch.branches = std::move(branches);
  for (FlightBranch& branch : stretch.branches) branch.fixed_on_stretch = false;
  for (std::size_t i = begin; i < end; ++i) {
    lose_flights(path, i, stretch);
    const double before = stretch.p_within_limit.empty() ? 1.0 : stretch.p_within_limit.back();
    stretch.p_within_limit.push_back(std::min(before, total_probability(stretch.branches)));  // sums are rounded
    if (path.gnss.at_sample[i]) take_gnss(path, i, stretch.branches);
    take_fix(path, chances, i, stretch);
    if (i >= path.steps.size()) continue;
    for (FlightBranch& branch : stretch.branches) branch.state = propagate(branch.state, path.steps[i]);
    if (path.gnss.over_step[i]) take_gnss(path, i + 1, stretch.branches);
  }
  return stretch;
}

RouteSurvival predict_survival(const FlightPath& path, std::span<const LevelChances> levels) {
  const std::vector<FlightSample>& samples = path.mission->flight.samples;
  const std::size_t leg_count = path.mission->flight.route.legs.size();
  RouteSurvival survival;
  survival.leg_p_within_limit.assign(leg_count, kNaN);
  survival.leg_p_fix.assign(leg_count, kNaN);
  survival.leg_entries.resize(leg_count);
  std::vector<std::pair<std::size_t, std::size_t>> losses;
  std::vector<std::vector<FlightBranch>> branches(levels.size(), first_branches(path));
  double before = 1;
  for (std::size_t begin = 0; begin < samples.size();) {
    std::size_t end = begin;
    while (end < samples.size() && samples[end].leg == samples[begin].leg) ++end;
    const auto leg = static_cast<std::size_t>(samples[begin].leg);
    survival.leg_entries[leg] = branches;
    survival.p_within_limit.resize(end, 0.0);
    survival.p_at_level.assign(levels.size(), 0.0);
    double p_fix = 0;
    for (std::size_t k = 0; k < levels.size(); ++k) {
      FlightStretch stretch = fly_stretch(path, levels[k].chances, begin, end, std::move(branches[k]));
      for (std::size_t i = begin; i < end; ++i) {
        survival.p_within_limit[i] += levels[k].weight * stretch.p_within_limit[i - begin];
      }
      survival.p_at_level[k] = std::min(1.0, stretch.p_within_limit.back());
      p_fix += levels[k].weight * stretch.p_fix;
      losses.insert(losses.end(), stretch.losses.begin(), stretch.losses.end());
      branches[k] = std::move(stretch.branches);
    }
    // Weights and states add up to 1 but for rounding.
    for (std::size_t i = begin; i < end; ++i) survival.p_within_limit[i] = std::min(1.0, survival.p_within_limit[i]);
    const double after = survival.p_within_limit.back();
    if (before > 0) {
      survival.leg_p_within_limit[leg] = std::min(1.0, after / before);
      survival.leg_p_fix[leg] = std::min(1.0, p_fix / before);
    }
    before = after;
    begin = end;
  }
  survival.worst = worst_stretch(path, survival.p_within_limit, losses);
  return survival;
}

RouteSurvival predict_survival(const FlightPath& path, const RouteChances& chances) {
  const std::vector<LevelChances> levels{{1, chances}};
  return predict_survival(path, levels);
}

}  // namespace pilotage
