#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>

#include "pilotage/base/statistics.h"
#include "pilotage/ins/ins_error_model.h"
#include "pilotage/replay/replayed_frame.h"

namespace pilotage {

/// Fewer innovations say nothing of a grade.
inline constexpr std::int64_t kLeastInnovations = 10;
/// Factors that are tried: 1/32 … 32.
inline constexpr double kLargestGradeFactor = 32;

/// How an inertial system drifted between fixes, beside its model: the factor by which all its figures must be
/// multiplied for the innovations to be most likely.
struct GradeFit {
  std::int64_t innovations = 0;
  double longest_gap_s = 0;                                    ///< Between two of the fixes.
  double mean_nis = std::numeric_limits<double>::quiet_NaN();  ///< At factor 1: 2 when the model holds.
  Interval nis_band{std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
  std::optional<double> factor;  ///< Nothing below kLeastInnovations, nor at an end of what is tried.
  /// 95 %, by the likelihood ratio. Nothing at an end that the innovations do not bound.
  std::optional<double> low;
  std::optional<double> high;
  std::string why_not;  ///< A sentence where there is no factor.
};

/// Fits the factor to the fixes that are not false: an error filter with the model's figures times the factor
/// (flightlog/drift_filter.h) flies from fix to fix, and predicts the next error of the inertial position with its
/// covariance S(factor); the likelihood is that of the innovations, normal with S. Each flight begins anew at its first
/// fix. Needs times and priors that are the inertial system's own. docs/methods/replay.md.
GradeFit fit_grade(std::span<const ReplayedFlight> flights, const InsErrorModel& model);

/// All figures of how errors grow, times `factor`.
InsErrorModel scaled_model(InsErrorModel model, double factor);

}  // namespace pilotage
