#include "pilotage/base/binomial_interval.h"

#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

// P(first ≤ X ≤ last) of a binomial X, term by term.
double binomial_sum(std::int64_t first, std::int64_t last, std::int64_t trials, double rate) {
  double sum = 0;
  for (std::int64_t k = first; k <= last; ++k) {
    sum += std::exp(std::lgamma(static_cast<double>(trials + 1)) - std::lgamma(static_cast<double>(k + 1)) -
                    std::lgamma(static_cast<double>(trials - k + 1)) + static_cast<double>(k) * std::log(rate) +
                    static_cast<double>(trials - k) * std::log1p(-rate));
  }
  return sum;
}

TEST(BinomialInterval, PublishedAndClosedForms) {
  EXPECT_EQ(binomial_interval(0, 10).low, 0);
  EXPECT_NEAR(binomial_interval(0, 10).high, 1 - std::pow(0.025, 0.1), 1e-13);
  EXPECT_NEAR(binomial_interval(10, 10).low, std::pow(0.025, 0.1), 1e-13);
  EXPECT_EQ(binomial_interval(10, 10).high, 1);
  // Five of ten, as statistical tables print it.
  EXPECT_NEAR(binomial_interval(5, 10).low, 0.1870860, 5e-8);
  EXPECT_NEAR(binomial_interval(5, 10).high, 0.8129140, 5e-8);
}

TEST(BinomialInterval, BoundsLeaveTheStatedTails) {
  for (const double confidence : {0.5, 0.95, 0.999}) {
    for (const std::int64_t trials : {1, 2, 7, 60, 500}) {
      for (const std::int64_t successes : {std::int64_t{0}, std::int64_t{1}, trials / 3, trials - 1, trials}) {
        SCOPED_TRACE(testing::Message() << successes << " of " << trials << " at " << confidence);
        const BinomialInterval interval = binomial_interval(successes, trials, confidence);
        const double tail = (1 - confidence) / 2;
        if (successes > 0) {
          EXPECT_NEAR(binomial_sum(successes, trials, trials, interval.low), tail, 1e-10);
        } else {
          EXPECT_EQ(interval.low, 0);
        }
        if (successes < trials) {
          EXPECT_NEAR(binomial_sum(0, successes, trials, interval.high), tail, 1e-10);
        } else {
          EXPECT_EQ(interval.high, 1);
        }
      }
    }
  }
}

TEST(BinomialInterval, ManyTrialsApproachTheNormalInterval) {
  const BinomialInterval interval = binomial_interval(250000, 1000000);
  const double half_width = 1.959964 * std::sqrt(0.25 * 0.75 / 1e6);
  EXPECT_NEAR(interval.low, 0.25 - half_width, 2e-6);
  EXPECT_NEAR(interval.high, 0.25 + half_width, 2e-6);
}

TEST(BinomialInterval, MirroredCountsGiveMirroredBounds) {
  const BinomialInterval few = binomial_interval(3, 5000);
  const BinomialInterval many = binomial_interval(4997, 5000);
  EXPECT_NEAR(few.low, 1 - many.high, 1e-13);
  EXPECT_NEAR(few.high, 1 - many.low, 1e-13);
}

TEST(BinomialInterval, NothingIsKnownWithoutTrials) {
  EXPECT_EQ(binomial_interval(0, 0).low, 0);
  EXPECT_EQ(binomial_interval(0, 0).high, 1);
}

TEST(BinomialInterval, RefusesWhatIsNoCountOrNoConfidence) {
  EXPECT_THROW(binomial_interval(-1, 10), UsageError);
  EXPECT_THROW(binomial_interval(11, 10), UsageError);
  EXPECT_THROW(binomial_interval(1, 10, 0), UsageError);
  EXPECT_THROW(binomial_interval(1, 10, 1), UsageError);
  EXPECT_THROW(binomial_interval(1, 10, std::nan("")), UsageError);
}

}  // namespace
}  // namespace pilotage
