#pragma once

#include <array>
#include <cstddef>

namespace pilotage {

/// How often fixes succeed at a place and in a season is not known from one date: the *level* of the place, a summand
/// of the logit of P that all its tiles share (docs/methods/matchability.md). What is known of it is a normal
/// distribution; this is a value it may have, in standard deviations from its mean, and how much it counts.
struct LevelNode {
  double z = 0;
  double weight = 0;  ///< All of them are 1 together.
};

/// The z between which the level lies in 80 of 100 cases: ±Φ⁻¹(0.9).
inline constexpr double kLevel80_z = 1.2815515655446004;

/// The levels at which a flight is predicted, ascending: every kLevel80_z / 2 from −4 to 4 of these steps, so that
/// kLevelLow and kLevelHigh are the ends of the 80 % interval. Weights in proportion to the normal density: the
/// trapezoidal rule, which converges exponentially for smooth functions (L. N. Trefethen, J. A. C. Weideman, The
/// exponentially convergent trapezoidal rule, SIAM Review 56(3), 2014). The P of a route can be steep in the level, and
/// there the rule of Gauss and Hermite, whose middle node alone weighs 0.41 of nine, errs by twice as much.
const std::array<LevelNode, 9>& level_nodes();

inline constexpr std::size_t kLevelLow = 2;
inline constexpr std::size_t kLevelHigh = 6;

/// 1 / (1 + e^−logit).
double logistic(double logit);

/// The mean of logistic(logit + sigma · z) over level_nodes(). sigma ≥ 0.
double p_over_level(double logit, double sigma);

/// The logit with p_over_level(logit, sigma) = p, to the last digits; −∞ for 0, ∞ for 1. Monotone in p.
double logit_of_p(double p, double sigma);

}  // namespace pilotage
