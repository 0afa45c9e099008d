#pragma once

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

#pragma GCC visibility push(default)

namespace pilotage {

// Covariances of a horizontal position: variances of east and north on the diagonal, m².

/// Of an error with the same standard deviation along every direction.
inline Eigen::Matrix2d isotropic_covariance_m2(double sigma_m) {
  return sigma_m * sigma_m * Eigen::Matrix2d::Identity();
}

/// Of a map's own georeference, each axis, where nobody says.
inline constexpr double kUnknownMapSigma_m = 1;

/// Standard deviation along the worst direction: the larger half axis of the error ellipse. NaN when a number is.
inline double largest_sigma_m(const Eigen::Matrix2d& covariance_m2) {
  const double mean = (covariance_m2(0, 0) + covariance_m2(1, 1)) / 2;
  const double half = (covariance_m2(0, 0) - covariance_m2(1, 1)) / 2;
  return std::sqrt(mean + std::hypot(half, covariance_m2(0, 1)));
}

/// Along the best direction; NaN when the matrix is no covariance.
inline double smallest_sigma_m(const Eigen::Matrix2d& covariance_m2) {
  const double mean = (covariance_m2(0, 0) + covariance_m2(1, 1)) / 2;
  const double half = (covariance_m2(0, 0) - covariance_m2(1, 1)) / 2;
  return std::sqrt(mean - std::hypot(half, covariance_m2(0, 1)));
}

/// dᵀ C⁻¹ d of a difference and its covariance: χ² of two degrees of freedom when the covariance is honest.
inline double mahalanobis_squared(const Eigen::Vector2d& difference_m, const Eigen::Matrix2d& covariance_m2) {
  const double determinant = covariance_m2(0, 0) * covariance_m2(1, 1) - covariance_m2(0, 1) * covariance_m2(1, 0);
  const Eigen::Vector2d scaled(covariance_m2(1, 1) * difference_m.x() - covariance_m2(0, 1) * difference_m.y(),
                               covariance_m2(0, 0) * difference_m.y() - covariance_m2(1, 0) * difference_m.x());
  return difference_m.dot(scaled) / determinant;
}

}  // namespace pilotage

#pragma GCC visibility pop
