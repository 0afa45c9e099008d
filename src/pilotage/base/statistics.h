#pragma once

#include <cstdint>
#include <vector>

#pragma GCC visibility push(default)

namespace pilotage {

struct Interval {
  double low = 0;
  double high = 0;
};

/// The exact interval of a rate of which `successes` of `trials` were seen (C. J. Clopper, E. S. Pearson, "The use of
/// confidence or fiducial limits illustrated in the case of the binomial", Biometrika 26, 1934): it covers the true
/// rate with at least the probability `confidence`, whatever the rate. [0, 1] without a trial. Good to 1e-12. Throws
/// UsageError unless 0 ≤ successes ≤ trials and 0 < confidence < 1.
Interval binomial_interval(std::int64_t successes, std::int64_t trials, double confidence = 0.95);

/// So many of so many: of tries, frames, flights.
struct Share {
  std::int64_t count = 0;
  std::int64_t of = 0;

  double value() const;       ///< NaN of none.
  Interval interval() const;  ///< binomial_interval() with a confidence of 0.95.
};

/// The interval that holds, with probability 0.95, the difference of two shares of the same trials: of `trials`,
/// `only_first` had the first and not the second, `only_second` the second alone (D. G. Bonett, R. M. Price, "Adjusted
/// Wald confidence interval for a difference of binomial proportions based on paired data", J. Educ. Behav. Stat. 37,
/// 2012). Within [-1, 1]; [-1, 1] without a trial. Throws UsageError when a number is negative or they exceed the
/// trials.
Interval paired_difference_interval(std::int64_t only_first, std::int64_t only_second, std::int64_t trials);

/// The value that a χ² variable of `degrees` degrees of freedom does not exceed with `probability`; relative error
/// below 1e-9 for degrees up to 1e6. Throws UsageError unless degrees > 0 and 0 < probability < 1.
double chi_squared_quantile(double probability, double degrees);

/// The chance that 0, 1, … all of independent events happen, each with its own `p` (S. D. Poisson, 1837).
std::vector<double> poisson_binomial(const std::vector<double>& p);

/// The value below which a share of the values lies, 0 ≤ share ≤ 1, linear between neighbours (R. J. Hyndman, Y. Fan,
/// "Sample quantiles in statistical packages", Am. Stat. 50, 1996, definition 7, which numpy takes too); NaN without
/// values.
double quantile(std::vector<double> values, double share);

/// The median of the lengths of errors that are normal in two axes, over the standard deviation of one (Lord Rayleigh,
/// 1880): √(2 ln 2).
inline constexpr double kMedianOfLengths = 1.1774100225154747;

}  // namespace pilotage

#pragma GCC visibility pop
