#include "pilotage/reroute/fix_age.h"

#include <algorithm>
#include <cmath>

#include "pilotage/ins/drift.h"
#include "pilotage/ins/ins_state.h"

namespace pilotage {
namespace {

// How long the state flies straight until its error is `limit_m`, at most kLongestGap_s.
double reach_s(const InsErrorModel& model, const InsState& state, double limit_m) {
  const auto within = [&](double time_s) {
    const InsState later = propagate(state, time_s, state.heading_deg, state.speed_mps, model);
    return position_error_m(later, model.sigma_multiple) <= limit_m;
  };
  if (!within(0)) return 0;
  double low_s = 0;
  double high_s = 1;
  while (within(high_s)) {
    low_s = high_s;
    high_s *= 2;
    if (high_s > kLongestGap_s) return kLongestGap_s;
  }
  for (int i = 0; i < 30; ++i) {
    const double middle_s = (low_s + high_s) / 2;
    (within(middle_s) ? low_s : high_s) = middle_s;
  }
  return low_s;
}

}  // namespace

FixAgeModel make_fix_age_model(const InsErrorModel& model, double speed_mps, double limit_m, double good_share,
                               double window_m, double step_m, int fixes_before) {
  const InsState start = initial_ins_state(model, 0, speed_mps);
  InsState fixed = start;
  for (int i = 0; i < fixes_before; ++i) {
    fixed = propagate(fixed, window_m / speed_mps, 0, speed_mps, model);
    fixed = update_with_fix(fixed, model.fix_sigma_m);
  }
  // A way so long that no line of the search needs it all is as good as any.
  constexpr double kFarEnough_m = 1e6;
  const auto reach_m = [&](const InsState& state, double error_m) {
    return std::min(kFarEnough_m, reach_s(model, state, error_m) * speed_mps);
  };
  FixAgeModel ages;
  ages.window_m = window_m;
  const double full_m = reach_m(fixed, limit_m);
  ages.bin_m = std::max(step_m, full_m / static_cast<double>(FixAges::kMostBins));
  ages.bins = std::clamp<std::size_t>(static_cast<std::size_t>(full_m / ages.bin_m), 1, FixAges::kMostBins);
  ages.start_age_m = std::max(0.0, full_m - reach_m(start, limit_m));
  ages.good_reach_m = reach_m(fixed, good_share * limit_m);
  ages.start_good_age_m = std::max(0.0, ages.good_reach_m - reach_m(start, good_share * limit_m));
  return ages;
}

FixAges ages_at_start(const FixAgeModel& model) {
  FixAges ages;
  const auto first = std::min(model.bins - 1, static_cast<std::size_t>(model.start_age_m / model.bin_m));
  std::fill(ages.within.begin() + static_cast<std::ptrdiff_t>(first), ages.within.end(), 1.0F);
  ages.since_matchable_m = static_cast<float>(model.start_good_age_m);
  return ages;
}

AgeStep age_step(const FixAgeModel& model, const FlownStep& step) {
  const double older = step.length_m / model.bin_m;
  AgeStep aged;
  aged.length_m = step.length_m;
  aged.bins = static_cast<std::uint32_t>(std::min(older, static_cast<double>(model.bins)));
  aged.bin_part = static_cast<float>(older - std::floor(older));
  aged.matchable = step.p > 0;
  if (aged.matchable) {
    aged.fixed = static_cast<float>(1 - std::pow(1 - static_cast<double>(step.p), step.length_m / model.window_m));
  }
  return aged;
}

void take_step(const FixAgeModel& model, const AgeStep& step, FixAges& ages) {
  // All bins, also those behind the model's last, and from values of their own: so the compiler makes wide loops.
  constexpr std::size_t kBins = FixAges::kMostBins;
  const std::size_t whole = std::min<std::size_t>(step.bins, kBins);
  const float part = step.bin_part;
  const float rest = 1 - part;
  std::array<float, 2 * kBins + 1> before;
  const auto youngest = before.begin() + kBins + 1;
  std::fill(youngest - static_cast<std::ptrdiff_t>(whole + 1), youngest, 0.0F);  // nobody is younger
  std::copy(ages.within.begin(), ages.within.end(), youngest);
  std::array<float, kBins> grown;
  const float* younger = before.data() + kBins - whole;
  for (std::size_t bin = 0; bin < kBins; ++bin) grown[bin] = rest * younger[bin + 1] + part * younger[bin];
  ages.since_matchable_m += step.length_m;
  if (step.matchable) {
    ages.since_matchable_m = 0;
    const float all = step.fixed * grown[model.bins - 1];
    const float missed = 1 - step.fixed;
    for (std::size_t bin = 0; bin < kBins; ++bin) grown[bin] = all + missed * grown[bin];
  }
  ages.within = grown;
}

}  // namespace pilotage
