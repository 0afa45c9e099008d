#pragma once

#include <cstdint>
#include <vector>

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

/// The value that a χ² variable of `degrees` degrees of freedom does not exceed with `probability`; relative error
/// below 1e-9 for degrees up to 1e6. Throws UsageError unless degrees > 0 and 0 < probability < 1.
double chi_squared_quantile(double probability, double degrees);

/// The value below which a share of the values lies, 0 ≤ share ≤ 1, linear between neighbours (R. J. Hyndman, Y. Fan,
/// "Sample quantiles in statistical packages", Am. Stat. 50, 1996, definition 7, which numpy takes too); NaN without
/// values.
double quantile(std::vector<double> values, double share);

}  // namespace pilotage
