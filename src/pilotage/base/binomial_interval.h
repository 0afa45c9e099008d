#pragma once

#include <cstdint>

namespace pilotage {

/// Between which rates the true one lies.
struct BinomialInterval {
  double low = 0;
  double high = 1;
};

/// The exact (Clopper–Pearson) confidence interval of a rate of which `successes` were seen in `trials` independent
/// trials: both bounds are the rates that would give a count as extreme as this one, or more, with probability
/// (1 − confidence) / 2. It covers the true rate at least as often as `confidence` says, for any number of trials
/// (C. J. Clopper, E. S. Pearson, Biometrika 26, 1934). Without trials nothing is known: [0, 1]. Absolute error below
/// 1e-12 up to 1e6 trials. Throws UsageError unless 0 ≤ successes ≤ trials and 0 < confidence < 1.
BinomialInterval binomial_interval(std::int64_t successes, std::int64_t trials, double confidence = 0.95);

}  // namespace pilotage
