#include "pilotage/select/route_probability.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

#include "pilotage/base/nan.h"
#include "pilotage/base/parallel.h"
#include "pilotage/ground/place_level.h"
#include "pilotage/ins/drift.h"
#include "pilotage/mission/wind_cases.h"

namespace pilotage {
namespace {

constexpr double kLeastShare = 1e-9;
constexpr double kSameError = 0.02;
constexpr std::size_t kMostGroups = 8;
constexpr double kRareShare = 0.001;
constexpr double kSearchSigmas = 3;  // to each side of a prior
constexpr double kLongestLeap_s = 10;

// How far the branch's flights are off the line that their navigation holds them on: rms of an axis.
double off_line_m(const FlightBranch& branch) {
  return std::sqrt(branch.position_covariance_m2.trace() / 2);
}

// Share of the square of half side 1 that lies beyond a circle of this radius around its middle.
double share_beyond(double radius) {
  if (radius >= std::numbers::sqrt2) return 0;
  if (radius <= 1) return 1 - std::numbers::pi / 4 * radius * radius;
  return 1 - std::sqrt(radius * radius - 1) - radius * radius * (std::numbers::pi / 4 - std::acos(1 / radius));
}

double total_probability(const std::vector<FlightBranch>& branches) {
  double total = 0;
  for (const FlightBranch& branch : branches) total += branch.probability;
  return total;
}

// Steps flown again and again as one: what is the same for all flights is worked out once.
class Leaps {
 public:
  explicit Leaps(const FlownSteps& steps) : steps_(steps) {}

  // From sample i over `count` steps that are all alike.
  const InsStep& over(std::size_t i, std::size_t count) {
    const InsStep& step = steps_[i];
    if (count == 1) return step;
    if (index_ != steps_.index(i)) {
      index_ = steps_.index(i);
      InsState alike;
      alike.heading_deg = step.heading_deg;
      alike.speed_mps = step.speed_mps;
      way_ = InsSpan(alike);
      made_.clear();
    }
    while (made_.size() < count) {
      way_.fly(step);
      made_.push_back(way_.as_step());
      made_.back().odometry = step.odometry;
    }
    return made_[count - 1];
  }

 private:
  const FlownSteps& steps_;
  std::optional<std::size_t> index_;  // of the step that `made_` repeats
  InsSpan way_{InsState()};
  std::vector<InsStep> made_;  // once, twice, …
};

// The flights of a stretch: their branches, whose states are those of the span's begin, and the span from there.
struct StretchUnderWay {
  FlightStretch stretch;
  InsSpan span;
  Leaps leaps;
  std::size_t judged_at = 0;  // the last sample at which errors were held against the limit
  InsSpan judged_span;        // the span as far as there; kept where more than one step is flown on
  std::size_t count = 0;      // steps flown since; 0 at the stretch's first sample

  // Another span begins where the states are.
  void begin_span() {
    if (!stretch.branches.empty()) span = InsSpan(stretch.branches.front().state);
  }
  // The states become those at the span's end, where another begins.
  void end_span() {
    for (FlightBranch& branch : stretch.branches) branch.state = span.end_of(branch.state);
    begin_span();
  }
};

bool is_beyond(const FlightPath& path, const Eigen::Matrix2d& position_covariance_m2) {
  return !(position_error_m(position_covariance_m2, path.model.sigma_multiple) <= path.max_error_m);
}

void see_positions(StretchUnderWay& flown) {
  const PositionAhead position = flown.span.position();
  for (FlightBranch& branch : flown.stretch.branches) {
    branch.position_covariance_m2 = position.covariance_m2(branch.state.covariance);
  }
}

// At which of the samples behind the last one judged (1 … count) a state's error is first beyond the limit, as it is at
// the last of them: in straight flight without GNSS errors grow.
std::size_t first_beyond(const FlightPath& path, const InsState& state, StretchUnderWay& flown) {
  std::size_t within = 0;
  std::size_t beyond = flown.count;
  while (beyond - within > 1) {
    const std::size_t middle = (within + beyond) / 2;
    InsSpan span = flown.judged_span;
    span.fly(flown.leaps.over(flown.judged_at, middle));  // with the manoeuvre there, if there is one
    (is_beyond(path, span.position().covariance_m2(state.covariance)) ? beyond : within) = middle;
  }
  return beyond;
}

// Takes out the branches that have come beyond the limit, and those that hold next to nothing; says what is left at
// each sample behind the last one judged.
void lose_flights(const FlightPath& path, std::size_t sample, StretchUnderWay& flown) {
  see_positions(flown);
  FlightStretch& stretch = flown.stretch;
  const double least = kLeastShare * total_probability(stretch.branches);
  const std::size_t first_loss = stretch.losses.size();
  std::erase_if(stretch.branches, [&](const FlightBranch& branch) {
    const bool beyond = is_beyond(path, branch.position_covariance_m2);
    if (beyond) {
      const std::size_t lost_at = flown.count == 0 ? sample : flown.judged_at + first_beyond(path, branch.state, flown);
      stretch.losses.push_back({branch.fix_sample, lost_at, branch.probability});
    }
    return beyond || branch.probability <= least;
  });
  const auto lost = stretch.losses.begin() + static_cast<std::ptrdiff_t>(first_loss);
  std::stable_sort(lost, stretch.losses.end(),
                   [](const LostFlights& a, const LostFlights& b) { return a.lost_at < b.lost_at; });
  const double left = total_probability(stretch.branches);
  for (std::size_t i = sample - (flown.count == 0 ? 0 : flown.count - 1); i <= sample; ++i) {
    double within = left;
    for (auto loss = lost; loss != stretch.losses.end(); ++loss) within += loss->lost_at > i ? loss->probability : 0;
    const double before = stretch.p_within_limit.empty() ? 1.0 : stretch.p_within_limit.back();
    stretch.p_within_limit.push_back(std::min(before, within));  // sums are rounded
  }
  flown.judged_at = sample;
}

// A branch just after a fix, and its error a horizon later.
struct FixedBranch {
  const FlightBranch* branch = nullptr;
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
    for (++i; i < fixed.size() && fixed[i].error_m <= most_m && same_draw(*fixed[i].branch, *first.branch);) ++i;
    ends.push_back(i);
  }
  return ends;
}

std::vector<FlightBranch> merge_alike(const FlightPath& path, const FlownSteps& steps, std::size_t sample,
                                      const InsSpan& span, const std::vector<FlightBranch>& branches) {
  std::vector<const InsState*> states;
  for (const FlightBranch& branch : branches) states.push_back(&branch.state);
  const std::vector<double> errors_m = steps.errors_ahead_m(sample, span, states, path.model.sigma_multiple);
  std::vector<FixedBranch> fixed;
  for (std::size_t i = 0; i < branches.size(); ++i) fixed.push_back({&branches[i], errors_m[i]});
  std::stable_sort(fixed.begin(), fixed.end(), [](const auto& a, const auto& b) {
    return std::tuple(a.branch->u_low, a.branch->u_high, a.error_m) <
           std::tuple(b.branch->u_low, b.branch->u_high, b.error_m);
  });
  double share = kSameError;
  std::vector<std::size_t> ends = group_ends(fixed, share);
  while (ends.size() > kMostGroups && share < 1) ends = group_ends(fixed, share *= 2);
  std::vector<FlightBranch> merged;
  merged.reserve(ends.size());
  std::size_t i = 0;
  for (const std::size_t end : ends) {
    double total = 0;
    for (std::size_t k = i; k < end; ++k) total += fixed[k].branch->probability;
    FlightBranch& group = merged.emplace_back(*fixed[i].branch);
    group.probability = total;
    group.state.covariance.setZero();
    for (; i < end; ++i) {
      group.state.covariance += fixed[i].branch->probability / total * fixed[i].branch->state.covariance;
    }
  }
  return merged;
}

// Branches that had their last fix together and of which each holds next to none of the flights become one.
void join_rare(std::vector<FlightBranch>& branches) {
  const double rare = kRareShare * total_probability(branches);
  std::size_t joined = 0;
  for (std::size_t i = 1; i < branches.size(); ++i) {
    FlightBranch& last = branches[joined];
    const FlightBranch& next = branches[i];
    const bool together = last.fix_sample == next.fix_sample && last.fix_time_s == next.fix_time_s &&
                          last.window == next.window && same_draw(last, next);
    if (together && last.probability < rare && next.probability < rare) {
      last.probability += next.probability;
      const double share = next.probability / last.probability;
      last.state.covariance += share * (next.state.covariance - last.state.covariance);
      last.position_covariance_m2 += share * (next.position_covariance_m2 - last.position_covariance_m2);
    } else if (++joined != i) {
      branches[joined] = next;
    }
  }
  branches.resize(std::min(branches.size(), joined + 1));
}

// Parts of all branches get a fix at the sample and become new branches.
void take_fix(const FlightPath& path, const FlownSteps& steps, const RouteChances& chances, std::size_t sample,
              StretchUnderWay& flown, std::vector<FlightBranch>* fixes) {
  const double p = path.frames_that_come * chances.p[sample];  // on the line
  FlightStretch& stretch = flown.stretch;
  if (!(p > 0) || stretch.branches.empty()) return;
  join_rare(stretch.branches);
  const SpanFix fix(flown.span, path.model.fix_sigma_m);
  std::vector<FlightBranch> fixed;
  fixed.reserve(stretch.branches.size());
  for (FlightBranch& branch : stretch.branches) {
    const double time_s = branch.state.time_s + flown.span.dt_s();
    if (time_s - branch.fix_time_s < chances.fix_interval_s - 1e-9) continue;
    if (branch.window != chances.window[sample]) {
      branch.window = chances.window[sample];
      branch.u_low = 0;
      branch.u_high = 1;
    }
    const double beside = chances.beside_line.empty() ? 1 : chances.beside_line[sample].share_at(off_line_m(branch));
    // The draw is held against P on the line, or no two branches could be merged.
    const double drawn = std::clamp((p - branch.u_low) / (branch.u_high - branch.u_low), 0.0, 1.0);
    const double share = std::min(1.0, beside * drawn);
    if (share > 0) {
      if (!branch.fixed_on_stretch) stretch.p_fix += share * branch.probability;
      FlightBranch& after = fixed.emplace_back(branch);
      after.fixed_on_stretch = true;
      after.fix_sample = sample;
      after.fix_time_s = time_s;
      after.probability *= share;
      after.u_high = std::min(branch.u_high, p);
      after.state.covariance = fix.fixed(branch.state.covariance);
    }
    const double searched_m = kSearchSigmas / path.model.sigma_multiple *
                              std::hypot(position_error_m(branch.position_covariance_m2, path.model.sigma_multiple),
                                         path.model.sigma_multiple * path.model.map_sigma_m);
    branch.probability *= (1 - share) * (1 - path.frames_that_come * chances.false_fix_rate *
                                                 share_beyond(path.max_error_m / searched_m));
    // Without a fix are those whose draw is above P, and those whose draw is not but who were beside: the more decide.
    if (1 - drawn >= drawn - share) branch.u_low = std::max(branch.u_low, p);
  }
  std::erase_if(stretch.branches, [](const FlightBranch& branch) { return branch.probability <= 0; });
  if (fixed.empty()) return;
  for (const FlightBranch& group : merge_alike(path, steps, sample, flown.span, fixed)) {
    stretch.branches.push_back(group);
    if (fixes == nullptr) continue;
    fixes->push_back(group);
    fixes->back().state = flown.span.end_of(group.state);
  }
}

// The states are those at the sample.
void take_gnss(const FlightPath& path, std::size_t sample, StretchUnderWay& flown) {
  for (FlightBranch& branch : flown.stretch.branches) {
    branch.fix_sample = sample;
    branch.state = held_with_gnss(path, sample, branch.state);
  }
  flown.begin_span();
}

// How many steps on from sample i the next thing happens: a try, a change of GNSS, another kind of step, the stretch's
// last sample.
std::size_t steps_to_next(const FlightPath& path, const FlownSteps& steps, const RouteChances& chances, std::size_t i,
                          std::size_t end) {
  const auto had = [&](std::size_t k) { return path.gnss.over_step[k] || path.gnss.at_sample[k + 1]; };
  if (steps[i].aided || had(i)) return 1;
  std::size_t count = 1;
  while (i + count + 1 < end && !(chances.p[i + count] > 0) && steps.index(i + count) == steps.index(i) &&
         !had(i + count) && static_cast<double>(count + 1) * steps[i].dt_s <= kLongestLeap_s) {
    ++count;
  }
  return count;
}

// `count` steps on from sample i. The states become those there where the span must end, and where the step has an
// aiding velocity.
void fly_on(const FlownSteps& steps, std::size_t i, std::size_t count, bool ends_span, StretchUnderWay& flown) {
  flown.count = count;
  if (flown.stretch.branches.empty()) return;
  if (steps[i].aided || (ends_span && !flown.span.is_flown())) {
    for (FlightBranch& branch : flown.stretch.branches) branch.state = propagate(branch.state, steps[i]);
    flown.begin_span();
    return;
  }
  if (count > 1) flown.judged_span = flown.span;
  flown.span.fly(flown.leaps.over(i, count));
  if (ends_span) flown.end_span();
}

// The value below which `share` of the weight of (value, weight) lies.
std::size_t weighted_quantile(std::vector<std::pair<std::size_t, double>> weighted, double share) {
  std::sort(weighted.begin(), weighted.end());
  double rest = 0;
  for (const auto& [value, weight] : weighted) rest += share * weight;
  for (const auto& [value, weight] : weighted) {
    rest -= weight;
    if (rest <= 0) return value;
  }
  return weighted.back().first;
}

// The losses of the leg with most, and of those the ones whose ways since the last fix overlap and that are most
// together.
std::vector<LostFlights> most_lost_together(const std::vector<FlightSample>& samples, std::vector<LostFlights> losses) {
  std::map<int, double> on_leg;
  for (const LostFlights& loss : losses) on_leg[samples[loss.lost_at].leg] += loss.probability;
  const auto less = [](const auto& a, const auto& b) { return a.second < b.second; };
  const int leg = std::max_element(on_leg.begin(), on_leg.end(), less)->first;
  std::erase_if(losses, [&](const LostFlights& loss) { return samples[loss.lost_at].leg != leg; });
  std::stable_sort(losses.begin(), losses.end(), [](const LostFlights& a, const LostFlights& b) {
    return std::pair(a.fix_sample, a.lost_at) < std::pair(b.fix_sample, b.lost_at);
  });
  std::vector<LostFlights> most;
  double most_probability = 0;
  for (std::size_t begin = 0; begin < losses.size();) {
    std::size_t end = begin;
    std::size_t reach = losses[begin].lost_at;
    double probability = 0;
    for (; end < losses.size() && losses[end].fix_sample <= reach; ++end) {
      reach = std::max(reach, losses[end].lost_at);
      probability += losses[end].probability;
    }
    if (probability > most_probability) {
      most.assign(losses.begin() + static_cast<std::ptrdiff_t>(begin),
                  losses.begin() + static_cast<std::ptrdiff_t>(end));
      most_probability = probability;
    }
    begin = end;
  }
  return most;
}

std::optional<WorstStretch> worst_stretch(const FlightPath& path, const std::vector<LostFlights>& losses) {
  if (losses.empty()) return {};
  constexpr double kLeftOut = 0.05;
  const std::vector<FlightSample>& samples = path.mission->flight.samples;
  std::vector<std::pair<std::size_t, double>> fixed_at;
  std::vector<std::pair<std::size_t, double>> lost_at;
  double probability = 0;
  for (const LostFlights& loss : most_lost_together(samples, losses)) {
    fixed_at.emplace_back(loss.fix_sample, loss.probability);
    lost_at.emplace_back(loss.lost_at, loss.probability);
    probability += loss.probability;
  }
  const FlightSample& from = samples[weighted_quantile(fixed_at, kLeftOut)];
  const FlightSample& to = samples[weighted_quantile(lost_at, 1 - kLeftOut)];
  return WorstStretch{to.leg, from.distance_m, to.distance_m, probability};
}

}  // namespace

FlightPath make_flight_path(const Mission& mission, double max_error_m, std::size_t levels) {
  FlightPath path;
  path.mission = &mission;
  path.model = make_error_model(mission.flight.ins, mission.flight.conditions);
  path.frames_that_come = 1 - mission.flight.conditions.dropped_frames;
  path.max_error_m = max_error_m;
  const double reach_s = longest_bridgeable_gap_s(path.model, mission.flight.samples.front().speed_mps, max_error_m,
                                                  path.model.sigma_multiple, path.model.fixed_position_sigma_m());
  path.horizon_s = std::clamp(reach_s, 1.0, 600.0);
  path.steps = FlownSteps(mission.flight, Eigen::Vector2d::Zero(), path.model, path.horizon_s);
  for (const WindCase& one : wind_cases(mission.flight.conditions.wind_sigma_mps, levels)) {
    path.cases.push_back(
        {one.level, one.node.weight, FlownSteps(mission.flight, one.node.wind_mps, path.model, path.horizon_s)});
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

FlightStretch fly_stretch(const FlightPath& path, const FlownSteps& steps, const RouteChances& chances,
                          std::size_t begin, std::size_t end, std::vector<FlightBranch> branches,
                          std::vector<FlightBranch>* fixes) {
  assert(end <= chances.p.size() && chances.p.size() == path.mission->flight.samples.size());
  const InsSpan span(branches.empty() ? InsState() : branches.front().state);
  StretchUnderWay flown{{}, span, Leaps(steps), begin, span};
  FlightStretch& stretch = flown.stretch;
  stretch.branches = std::move(branches);
  for (FlightBranch& branch : stretch.branches) branch.fixed_on_stretch = false;
  for (std::size_t i = begin; i < end; i += flown.count) {
    lose_flights(path, i, flown);
    if (flown.span.is_long()) flown.end_span();
    if (path.gnss.at_sample[i]) {
      take_gnss(path, i, flown);
      see_positions(flown);
    }
    take_fix(path, steps, chances, i, flown, fixes);
    if (i >= steps.size()) break;
    const std::size_t count = steps_to_next(path, steps, chances, i, end);
    fly_on(steps, i, count, i + 1 == end || path.gnss.over_step[i] || path.gnss.at_sample[i + 1], flown);
    if (path.gnss.over_step[i]) take_gnss(path, i + 1, flown);
  }
  if (flown.span.is_flown()) flown.end_span();
  return std::move(flown.stretch);
}

RouteSurvival predict_survival(const FlightPath& path, std::span<const LevelChances> levels, int threads,
                               double entries_below) {
  const std::vector<FlightSample>& samples = path.mission->flight.samples;
  const std::size_t leg_count = path.mission->flight.route.legs.size();
  RouteSurvival survival;
  survival.leg_p_within_limit.assign(leg_count, kNaN);
  survival.leg_p_fix.assign(leg_count, kNaN);
  survival.leg_entries.resize(leg_count);
  std::vector<LostFlights> losses;
  std::vector<FlightStretch> flown(path.cases.size());
  for (FlightStretch& stretch : flown) stretch.branches = first_branches(path);
  double before = 1;
  for (std::size_t begin = 0; begin < samples.size();) {
    std::size_t end = begin;
    while (end < samples.size() && samples[end].leg == samples[begin].leg) ++end;
    const auto leg = static_cast<std::size_t>(samples[begin].leg);
    std::vector<std::vector<FlightBranch>> entries(flown.size());
    parallel_for(flown.size(), threads, [&](std::size_t k, int) {
      const FlightCase& one = path.cases[k];
      entries[k] = flown[k].branches;
      flown[k] = fly_stretch(path, one.steps, levels[one.level].chances, begin, end, std::move(flown[k].branches));
    });
    survival.p_within_limit.resize(end, 0.0);
    survival.p_at_level.assign(levels.size(), 0.0);
    double p_fix = 0;
    for (std::size_t k = 0; k < flown.size(); ++k) {
      const FlightCase& one = path.cases[k];
      const FlightStretch& stretch = flown[k];
      const double weight = levels[one.level].weight * one.weight;
      for (std::size_t i = begin; i < end; ++i) {
        survival.p_within_limit[i] += weight * stretch.p_within_limit[i - begin];
      }
      survival.p_at_level[one.level] += one.weight * std::min(1.0, stretch.p_within_limit.back());
      p_fix += weight * stretch.p_fix;
      for (LostFlights loss : stretch.losses) {
        loss.probability *= weight;
        losses.push_back(loss);
      }
    }
    // Weights and states add up to 1 but for rounding.
    for (std::size_t i = begin; i < end; ++i) survival.p_within_limit[i] = std::min(1.0, survival.p_within_limit[i]);
    const double after = survival.p_within_limit.back();
    if (before > 0) {
      survival.leg_p_within_limit[leg] = std::min(1.0, after / before);
      survival.leg_p_fix[leg] = std::min(1.0, p_fix / before);
      if (survival.leg_p_within_limit[leg] < entries_below) survival.leg_entries[leg] = std::move(entries);
    }
    before = after;
    begin = end;
  }
  survival.worst = worst_stretch(path, losses);
  return survival;
}

RouteSurvival predict_survival(const FlightPath& path, const RouteChances& chances) {
  const LevelChances alone{1, chances};
  return predict_survival(path, {&alone, 1}, 1);
}

std::optional<ProbabilityInterval> interval_over_levels(const RouteSurvival& survival) {
  if (survival.p_at_level.size() <= 1) return std::nullopt;
  // More fixes should never make a flight worse, but branches are merged, so P at the higher level can come out a
  // little smaller: the ends are sorted.
  const auto [low, high] = std::minmax(survival.p_at_level[kLevelLow], survival.p_at_level[kLevelHigh]);
  // Where only the worst levels lose the flight, they pull the mean below P at the lower end.
  const double p = survival.p_within_limit.back();
  return ProbabilityInterval{std::min(low, p), std::max(high, p)};
}

}  // namespace pilotage
