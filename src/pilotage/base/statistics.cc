#include "pilotage/base/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

constexpr int kMaxTerms = 100000;
constexpr double kTiny = 1e-300;  // keeps a continued fraction away from division by zero
constexpr double kPrecision = 1e-16;

/// a_1/(b_1 + a_2/(b_2 + …)) by W. J. Lentz's algorithm as modified by I. J. Thompson and A. R. Barnett (J. Comput.
/// Phys. 64, 1986), started from `f`: `term(i)` gives {a_i, b_i}.
template <class Term>
double continued_fraction(double f, Term term) {
  double c = f;
  double d = 0;
  for (int i = 1; i <= kMaxTerms; ++i) {
    const auto [a, b] = term(i);
    d = b + a * d;
    c = b + a / c;
    if (std::abs(d) < kTiny) d = kTiny;
    if (std::abs(c) < kTiny) c = kTiny;
    d = 1 / d;
    const double step = c * d;
    f *= step;
    if (std::abs(step - 1) < kPrecision) break;
  }
  return f;
}

struct Term {
  double a;
  double b;
};

/// Regularised incomplete beta function I_x(a, b) (NIST Handbook of Mathematical Functions, 8.17.22).
double incomplete_beta(double x, double a, double b) {
  if (x <= 0) return 0;
  if (x >= 1) return 1;
  if (x > (a + 1) / (a + b + 2)) return 1 - incomplete_beta(1 - x, b, a);
  const double front =
      std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x)) / a;
  const double fraction = continued_fraction(1, [&](int i) -> Term {
    const int m = i / 2;
    const double d = i % 2 == 0 ? m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m))
                                : -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
    return {d, 1};
  });
  return front / fraction;
}

/// Regularised incomplete gamma function P(a, x): its series below a + 1 (8.7.1), the continued fraction of Q above
/// (8.9.2, even part).
double incomplete_gamma(double a, double x) {
  if (x <= 0) return 0;
  const double front = std::exp(a * std::log(x) - x - std::lgamma(a));
  if (x < a + 1) {
    double term = 1 / a;
    double sum = term;
    for (int i = 1; i <= kMaxTerms && term > sum * kPrecision; ++i) {
      term *= x / (a + i);
      sum += term;
    }
    return front * sum;
  }
  const double fraction = continued_fraction(x + 1 - a, [&](int i) -> Term {
    return {-i * (i - a), x + 2 * i + 1 - a};
  });
  return 1 - front / fraction;
}

/// Where the rising function `f` reaches `value`, in [low, high].
template <class Function>
double bisect(double low, double high, double value, Function f) {
  for (int step = 0; step < 200; ++step) {
    const double middle = low + (high - low) / 2;
    if (middle <= low || middle >= high) break;
    (f(middle) < value ? low : high) = middle;
  }
  return low + (high - low) / 2;
}

void check_probability(const char* name, double probability) {
  if (probability > 0 && probability < 1) return;
  throw UsageError(std::string(name) + " = " + format_number(probability) + " is not between 0 and 1");
}

}  // namespace

Interval binomial_interval(std::int64_t successes, std::int64_t trials, double confidence) {
  check_probability("confidence", confidence);
  if (successes < 0 || successes > trials) {
    throw UsageError(std::to_string(successes) + " successes of " + std::to_string(trials) + " trials");
  }
  if (trials == 0) return {0, 1};
  const auto k = static_cast<double>(successes);
  const auto n = static_cast<double>(trials);
  const double tail = (1 - confidence) / 2;
  Interval interval{0, 1};
  if (successes > 0) {
    interval.low = bisect(0, 1, tail, [&](double rate) { return incomplete_beta(rate, k, n - k + 1); });
  }
  if (successes < trials) {
    interval.high = bisect(0, 1, 1 - tail, [&](double rate) { return incomplete_beta(rate, k + 1, n - k); });
  }
  return interval;
}

double Share::value() const {
  return of > 0 ? static_cast<double>(count) / static_cast<double>(of) : kNaN;
}

Interval Share::interval() const {
  return binomial_interval(count, of);
}

Interval paired_difference_interval(std::int64_t only_first, std::int64_t only_second, std::int64_t trials) {
  if (only_first < 0 || only_second < 0 || only_first + only_second > trials) {
    throw UsageError("a paired difference of " + std::to_string(only_first) + " and " + std::to_string(only_second) +
                     " of " + std::to_string(trials) + " trials is not possible");
  }
  if (trials == 0) return {-1, 1};
  const double n = static_cast<double>(trials) + 2;
  const double first = (static_cast<double>(only_first) + 1) / n;
  const double second = (static_cast<double>(only_second) + 1) / n;
  const double difference = first - second;
  const double half = std::sqrt(chi_squared_quantile(0.95, 1) * (first + second - difference * difference) / n);
  return {std::max(-1.0, difference - half), std::min(1.0, difference + half)};
}

double chi_squared_quantile(double probability, double degrees) {
  check_probability("probability", probability);
  if (!(degrees > 0) || std::isinf(degrees)) {
    throw UsageError("degrees = " + format_number(degrees) + " is not above 0");
  }
  const auto cumulative = [&](double value) { return incomplete_gamma(degrees / 2, value / 2); };
  double high = degrees + 10;
  while (cumulative(high) < probability) high *= 2;
  return bisect(0, high, probability, cumulative);
}

std::vector<double> poisson_binomial(const std::vector<double>& p) {
  std::vector<double> chance{1};
  for (const double one : p) {
    chance.push_back(0);
    for (std::size_t k = chance.size() - 1; k > 0; --k) chance[k] = chance[k] * (1 - one) + chance[k - 1] * one;
    chance[0] *= 1 - one;
  }
  return chance;
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const double place = std::clamp(share, 0.0, 1.0) * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (place - static_cast<double>(below)) * (values[above] - values[below]);
}

}  // namespace pilotage
