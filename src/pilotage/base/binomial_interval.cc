#include "pilotage/base/binomial_interval.h"

#include <cmath>
#include <string>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

// The continued fraction of the incomplete beta function (NIST DLMF 8.17.22) by the modified Lentz algorithm (W. J.
// Lentz, Applied Optics 15, 1976; I. J. Thompson, A. R. Barnett, J. Comp. Phys. 64, 1986). Converges in O(√max(a, b))
// steps for x < (a + 1) / (a + b + 2).
double beta_fraction(double x, double a, double b) {
  constexpr double kTiny = 1e-300;
  const auto nonzero = [](double value) { return std::abs(value) < kTiny ? kTiny : value; };
  double c = 1;
  double d = 1 / nonzero(1 - (a + b) * x / (a + 1));
  double result = d;
  for (int m = 1; m < 100000; ++m) {
    const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
    d = 1 / nonzero(1 + even * d);
    c = nonzero(1 + even / c);
    result *= c * d;
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
    d = 1 / nonzero(1 + odd * d);
    c = nonzero(1 + odd / c);
    result *= c * d;
    if (std::abs(c * d - 1) < 1e-15) break;
  }
  return result;
}

// Regularised incomplete beta function I_x(a, b), 0 < x < 1.
double incomplete_beta(double x, double a, double b) {
  const double front =
      std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x));
  if (x < (a + 1) / (a + b + 2)) return front * beta_fraction(x, a, b) / a;
  return 1 - front * beta_fraction(1 - x, b, a) / b;
}

// The x at which I_x(a, b) = probability; I grows with x.
double beta_quantile(double probability, double a, double b) {
  double low = 0;
  double high = 1;
  for (;;) {
    const double middle = low + (high - low) / 2;
    if (middle <= low || middle >= high) return middle;
    (incomplete_beta(middle, a, b) < probability ? low : high) = middle;
  }
}

}  // namespace

BinomialInterval binomial_interval(std::int64_t successes, std::int64_t trials, double confidence) {
  if (successes < 0 || successes > trials) {
    throw UsageError("successes = " + std::to_string(successes) + ": allowed are 0 to the number of trials, " +
                     std::to_string(trials));
  }
  if (!(confidence > 0 && confidence < 1)) {
    throw UsageError("confidence = " + format_number(confidence) + ": allowed is what lies between 0 and 1");
  }
  const double tail = (1 - confidence) / 2;
  const auto hits = static_cast<double>(successes);
  const auto misses = static_cast<double>(trials - successes);
  BinomialInterval interval;
  if (successes > 0) interval.low = beta_quantile(tail, hits, misses + 1);
  if (successes < trials) interval.high = beta_quantile(1 - tail, hits + 1, misses);
  return interval;
}

}  // namespace pilotage
