#include "pilotage/select/fix_chain.h"

#include <algorithm>
#include <optional>

namespace pilotage {
namespace {

/// The least P that an attempt is given while the chain is made, so that some flights have a fix there and show the
/// error after it, even where no tile is stored.
constexpr double kFaint = 1e-4;
constexpr double kMeanWeight = 1e-3;
constexpr double kNothing = 1e-12;  // of a group of flights: what is left of it is not followed

/// The way from one node to the next, in up to three parts: without GNSS to the first sample that has it, on to the
/// last one that has it, and without it to the node. What is denied between those two samples is not looked at.
struct NodeStep {
  struct WithGnss {
    std::size_t back = 0;
    std::size_t lost = 0;
    InsStep step;
    InsStep on;
  };
  InsStep step;
  std::optional<WithGnss> gnss;
};

// Straight and at the speed of its first sample.
InsStep straight_step(const FlightPath& path, std::size_t from, std::size_t to) {
  const FlightSample& at = path.mission->flight.samples[from];
  double step_s = 0;
  for (std::size_t i = from; i < to; ++i) step_s += path.steps[i].dt_s;
  return make_ins_step(step_s, at.azimuth_deg, at.speed_mps, path.model);
}

std::vector<NodeStep> node_steps(const FlightPath& path, const std::vector<std::size_t>& sample_of_node) {
  std::vector<NodeStep> steps;
  for (std::size_t k = 0; k + 1 < sample_of_node.size(); ++k) {
    const std::size_t from = sample_of_node[k];
    const std::size_t to = sample_of_node[k + 1];
    const auto has_gnss = [&](std::size_t i) {
      return path.gnss.at_sample[i] || (i > from && path.gnss.over_step[i - 1]);
    };
    std::size_t back = from;
    while (back <= to && !has_gnss(back)) ++back;
    NodeStep& step = steps.emplace_back();
    step.step = straight_step(path, from, std::min(back, to));
    if (back > to) continue;
    std::size_t lost = to;
    while (!has_gnss(lost)) --lost;
    step.gnss = NodeStep::WithGnss{back, lost, straight_step(path, back, lost), straight_step(path, lost, to)};
  }
  return steps;
}

std::size_t fly_on(const FlightPath& path, const std::vector<NodeStep>& steps, std::size_t node, InsState state) {
  const auto beyond = [&] { return !(position_error_m(state, path.model.sigma_multiple) <= path.max_error_m); };
  for (std::size_t next = node; next < steps.size(); ++next) {
    state = propagate(state, steps[next].step);
    if (beyond()) return next;
    if (!steps[next].gnss) continue;
    const NodeStep::WithGnss& gnss = *steps[next].gnss;
    state = propagate(held_with_gnss(path, gnss.back, state), gnss.step);
    state = propagate(held_with_gnss(path, gnss.lost, state), gnss.on);
    if (beyond()) return next;
  }
  return steps.size();
}

}  // namespace

FixChain make_fix_chain(const FlightPath& path, const std::vector<FixAttempt>& attempts,
                        const std::vector<double>& p_of_tile) {
  const std::size_t sample_count = path.mission->flight.samples.size();
  std::vector<std::size_t> sample_of_node = {0};
  for (const FixAttempt& attempt : attempts) sample_of_node.push_back(attempt.sample);
  sample_of_node.push_back(sample_count - 1);
  const std::vector<NodeStep> steps = node_steps(path, sample_of_node);

  RouteChances chances = route_chances(attempts, p_of_tile, sample_count, {});
  for (const FixAttempt& attempt : attempts) chances.p[attempt.sample] = std::max(chances.p[attempt.sample], kFaint);
  std::vector<FlightBranch> fixes;
  fly_stretch(path, path.steps, chances, 0, sample_count, first_branches(path), &fixes);

  FixChain chain;
  chain.last.push_back(fly_on(path, steps, 0, first_branches(path).front().state));
  auto fix = fixes.begin();
  for (std::size_t k = 0; k < attempts.size(); ++k) {
    while (fix != fixes.end() && fix->fix_sample < attempts[k].sample) ++fix;
    auto likeliest = fixes.end();  // of the groups that this fix made
    for (; fix != fixes.end() && fix->fix_sample == attempts[k].sample; ++fix) {
      if (likeliest == fixes.end() || fix->probability > likeliest->probability) likeliest = fix;
    }
    chain.last.push_back(likeliest != fixes.end() ? fly_on(path, steps, k + 1, likeliest->state) : k + 1);
  }
  return chain;
}

ChainValue chain_value(const FixChain& chain, const std::vector<double>& p) {
  const std::size_t end = chain.end();
  const double node_weight = kMeanWeight / static_cast<double>(end);
  // fixed[j]: P of a fix at j within the limit. reached[j]: P of coming to j within the limit.
  std::vector<double> fixed(end, 0.0);
  std::vector<double> reached(end + 1, 0.0);
  std::vector<std::size_t> last = chain.last;  // cut where next to nothing is left of the flights
  fixed[0] = 1;
  for (std::size_t j = 0; j < end; ++j) {
    if (j > 0) fixed[j] = reached[j] * p[j];
    double missed = 1;
    for (std::size_t c = j + 1; c <= last[j]; ++c) {
      reached[c] += fixed[j] * missed;
      if (c < end) missed *= 1 - p[c];
      if (missed < kNothing) last[j] = c;
    }
  }
  ChainValue result;
  result.slope.assign(end + 1, 0.0);
  std::vector<double> after_fix(end, 0.0);  // value that is still to come after a fix at the node
  std::vector<double> missed;
  for (std::size_t j = end; j-- > 0;) {
    missed.assign(1, 1.0);
    for (std::size_t c = j + 1; c <= last[j] && c < end; ++c) missed.push_back(missed.back() * (1 - p[c]));
    double to_come = last[j] == end ? 1.0 : 0.0;
    for (std::size_t c = std::min(last[j], end - 1); c > j; --c) {
      result.slope[c] += fixed[j] * missed[c - j - 1] * (after_fix[c] - to_come);
      to_come = node_weight + p[c] * after_fix[c] + (1 - p[c]) * to_come;
    }
    after_fix[j] = to_come;
  }
  result.value = after_fix[0] + node_weight;
  return result;
}

}  // namespace pilotage
