#include "pilotage/base/statistics.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

struct IntervalCase {
  std::int64_t successes;
  std::int64_t trials;
  double confidence;
  double low;
  double high;
};

// Sums of binomial probabilities in 60-digit arithmetic, solved by bisection (Python's decimal).
TEST(BinomialInterval, AgreesWithExactSums) {
  const IntervalCase cases[] = {{0, 10, 0.95, 0, 0.308497107818761},
                                {1, 10, 0.95, 0.002528578544462, 0.445016117028195},
                                {5, 10, 0.95, 0.187086028447399, 0.812913971552601},
                                {8, 10, 0.95, 0.443904537692358, 0.974789273673167},
                                {10, 10, 0.95, 0.691502892181239, 1},
                                {1, 1000, 0.95, 0.000025317487491, 0.005558924279827},
                                {963, 1000, 0.95, 0.949358876940075, 0.973817291156263},
                                {3, 497, 0.95, 0.001246547193628, 0.017538296154699},
                                {2, 7, 0.9, 0.053375500470237, 0.658738563844664},
                                {481, 500, 0.99, 0.934193893923043, 0.980547403804272}};
  for (const IntervalCase& c : cases) {
    const Interval interval = binomial_interval(c.successes, c.trials, c.confidence);
    EXPECT_NEAR(interval.low, c.low, 1e-12) << c.successes << " of " << c.trials;
    EXPECT_NEAR(interval.high, c.high, 1e-12) << c.successes << " of " << c.trials;
  }
}

// Without a success in n trials the upper end is 1 − (α/2)^(1/n): a closed form far beyond what sums can do.
TEST(BinomialInterval, EndsHaveAClosedForm) {
  for (const std::int64_t n : {std::int64_t{1}, std::int64_t{30}, std::int64_t{5000}, std::int64_t{1000000}}) {
    const double high = -std::expm1(std::log(0.025) / static_cast<double>(n));
    EXPECT_NEAR(binomial_interval(0, n).high, high, 1e-9 * high) << n;
    EXPECT_NEAR(1 - binomial_interval(n, n).low, high, 1e-9 * high + 1e-15) << n;
    EXPECT_EQ(binomial_interval(0, n).low, 0);
    EXPECT_EQ(binomial_interval(n, n).high, 1);
  }
}

// Worked by hand: (b + 1 - (c + 1)) / (n + 2) and its standard error.
TEST(PairedDifferenceInterval, IsTheAdjustedWaldInterval) {
  const Interval interval = paired_difference_interval(60, 0, 1000);
  const double half = 1.959963984540054 * std::sqrt((62 / 1002.0 - std::pow(60 / 1002.0, 2)) / 1002);
  EXPECT_NEAR(interval.low, 60 / 1002.0 - half, 1e-12);
  EXPECT_NEAR(interval.high, 60 / 1002.0 + half, 1e-12);
  const Interval mirrored = paired_difference_interval(0, 60, 1000);
  EXPECT_DOUBLE_EQ(mirrored.low, -interval.high);
  EXPECT_EQ(paired_difference_interval(1, 0, 1).high, 1);
  EXPECT_EQ(paired_difference_interval(0, 0, 0).low, -1);
  EXPECT_LT(paired_difference_interval(0, 0, 50).low, 0) << "no difference seen is not none";
  EXPECT_THROW(paired_difference_interval(2, 2, 3), UsageError);
  EXPECT_THROW(paired_difference_interval(-1, 2, 3), UsageError);
}

TEST(BinomialInterval, NothingSeenSaysNothing) {
  EXPECT_EQ(binomial_interval(0, 0).low, 0);
  EXPECT_EQ(binomial_interval(0, 0).high, 1);
}

TEST(Share, HasAValueAndAnInterval) {
  const Share share{963, 1000};
  EXPECT_EQ(share.value(), 0.963);
  EXPECT_EQ(share.interval().low, binomial_interval(963, 1000, 0.95).low);
  EXPECT_EQ(share.interval().high, binomial_interval(963, 1000, 0.95).high);
  EXPECT_TRUE(std::isnan(Share{}.value()));
  EXPECT_EQ(Share{}.interval().high, 1);
}

TEST(BinomialInterval, RefusesWhatIsNoShare) {
  EXPECT_THROW(binomial_interval(-1, 3), UsageError);
  EXPECT_THROW(binomial_interval(4, 3), UsageError);
  EXPECT_THROW(binomial_interval(1, 3, 1), UsageError);
  EXPECT_THROW(binomial_interval(1, 3, std::numeric_limits<double>::quiet_NaN()), UsageError);
}

struct QuantileCase {
  double probability;
  double degrees;
  double value;
};

// For even degrees the distribution is a finite sum; solved in 60-digit arithmetic (Python's decimal).
TEST(ChiSquaredQuantile, AgreesWithExactSums) {
  const QuantileCase cases[] = {{0.975, 2, 7.377758908228},     {0.025, 2, 0.050635615969},
                                {0.95, 10, 18.307038053275},    {0.025, 10, 3.246972780237},
                                {0.025, 960, 876.028394364282}, {0.975, 960, 1047.759649476826},
                                {0.5, 4, 3.356693980033},       {1e-6, 6, 0.036508565927},
                                {0.999999, 6, 38.258336377210}, {0.975, 20000, 20393.883649999766}};
  for (const QuantileCase& c : cases) {
    EXPECT_NEAR(chi_squared_quantile(c.probability, c.degrees), c.value, 1e-9 * c.value + 1e-12)
        << c.probability << " of " << c.degrees;
  }
}

// One degree of freedom is the square of a standard normal variable.
TEST(ChiSquaredQuantile, OneDegreeIsTheNormalSquared) {
  EXPECT_NEAR(chi_squared_quantile(0.95, 1), 1.959963984540054 * 1.959963984540054, 1e-9);
}

TEST(ChiSquaredQuantile, RefusesWhatHasNone) {
  EXPECT_THROW(chi_squared_quantile(0, 2), UsageError);
  EXPECT_THROW(chi_squared_quantile(1, 2), UsageError);
  EXPECT_THROW(chi_squared_quantile(0.5, 0), UsageError);
  EXPECT_THROW(chi_squared_quantile(0.5, std::numeric_limits<double>::infinity()), UsageError);
}

TEST(PoissonBinomial, EqualChancesAreABinomialAndCertainOnesShiftIt) {
  const std::vector<double> three = poisson_binomial({0.2, 0.2, 0.2});
  ASSERT_EQ(three.size(), 4U);
  EXPECT_DOUBLE_EQ(three[0], 0.512);
  EXPECT_DOUBLE_EQ(three[1], 0.384);
  EXPECT_DOUBLE_EQ(three[2], 0.096);
  EXPECT_DOUBLE_EQ(three[3], 0.008);
  const std::vector<double> mixed = poisson_binomial({1, 0.25, 0});
  EXPECT_DOUBLE_EQ(mixed[0], 0);
  EXPECT_DOUBLE_EQ(mixed[1], 0.75);
  EXPECT_DOUBLE_EQ(mixed[2], 0.25);
  EXPECT_DOUBLE_EQ(mixed[3], 0);
  EXPECT_EQ(poisson_binomial({}), std::vector<double>{1});
}

// numpy.quantile's default.
TEST(Quantile, IsLinearBetweenNeighbours) {
  EXPECT_EQ(quantile({3, 1, 2, 4}, 0.5), 2.5);
  EXPECT_EQ(quantile({3, 1, 2}, 0.5), 2);
  EXPECT_DOUBLE_EQ(quantile({1, 2, 3, 4, 5}, 0.95), 4.8);
  EXPECT_EQ(quantile({7}, 0.95), 7);
  EXPECT_EQ(quantile({1, 2}, 0), 1);
  EXPECT_EQ(quantile({1, 2}, 1), 2);
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
}

}  // namespace
}  // namespace pilotage
