#include "pilotage/ground/place_level.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace pilotage {
namespace {

/// ∫ logistic(logit + sigma z) N(z) dz by a fine midpoint rule.
double brute_force(double logit, double sigma) {
  constexpr double kStep = 1e-3;
  double sum = 0;
  for (double z = -9 + kStep / 2; z < 9; z += kStep) {
    sum += std::exp(-z * z / 2) / (1 + std::exp(-(logit + sigma * z)));
  }
  return sum * kStep / std::sqrt(2 * std::acos(-1.0));
}

TEST(PlaceLevel, NodesHaveTheMomentsOfTheNormalDistribution) {
  double total = 0;
  double mean = 0;
  double variance = 0;
  for (const LevelNode& node : level_nodes()) {
    total += node.weight;
    mean += node.weight * node.z;
    variance += node.weight * node.z * node.z;
  }
  EXPECT_NEAR(total, 1, 1e-14);
  EXPECT_NEAR(mean, 0, 1e-14);
  EXPECT_NEAR(variance, 1, 0.06) << "what lies beyond the outermost nodes is lost";
  EXPECT_NEAR(level_nodes()[kLevelLow].z, -kLevel80_z, 1e-15);
  EXPECT_NEAR(level_nodes()[kLevelHigh].z, kLevel80_z, 1e-15);
  EXPECT_NEAR(std::erfc(-kLevel80_z / std::sqrt(2.0)) / 2, 0.9, 1e-12);
}

TEST(PlaceLevel, TheMeanIsThatOfTheIntegral) {
  double largest = 0;
  for (const double sigma : {0.2, 1.0, 2.0, 3.0}) {
    for (double logit = -8; logit <= 8; logit += 0.5) {
      largest = std::max(largest, std::abs(p_over_level(logit, sigma) - brute_force(logit, sigma)));
    }
  }
  EXPECT_LT(largest, 0.006);
}

TEST(PlaceLevel, WithoutASpreadItIsTheLogisticFunction) {
  for (const double logit : {-3.0, 0.0, 2.5}) EXPECT_EQ(p_over_level(logit, 0), 1 / (1 + std::exp(-logit)));
}

TEST(PlaceLevel, TheLogitComesBack) {
  for (const double sigma : {0.0, 0.5, 2.5}) {
    for (const double logit : {-12.0, -1.0, 0.0, 0.3, 7.0}) {
      EXPECT_NEAR(logit_of_p(p_over_level(logit, sigma), sigma), logit, 1e-6) << sigma;
    }
  }
  EXPECT_EQ(logit_of_p(0, 1), -std::numeric_limits<double>::infinity());
  EXPECT_EQ(logit_of_p(1, 1), std::numeric_limits<double>::infinity());
}

TEST(PlaceLevel, WhatIsLessWellKnownPromisesLess) {
  EXPECT_GT(p_over_level(6, 0), 0.997);
  EXPECT_LT(p_over_level(6, 2.5), 0.985);
  EXPECT_GT(p_over_level(-6, 2.5), p_over_level(-6, 0));
}

}  // namespace
}  // namespace pilotage
