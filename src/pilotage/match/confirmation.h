#pragma once

#include <Eigen/Core>

#pragma GCC visibility push(default)

namespace pilotage {

/// Whether a candidate lies where a track says: `difference_m` is candidate minus track, `covariance_m2` that of the
/// difference when both are right. The ellipse holds kAgreementShare of right candidates.
bool agrees_with_track(const Eigen::Vector2d& difference_m, const Eigen::Matrix2d& covariance_m2);

/// The rate at which a frame of other ground has its best place inside that ellipse, and with this evidence
/// (MatchStats::vote_peak):
///   exp(−evidence) · a / A,   a = π χ² √det(covariance), at most A
/// exp(−evidence) is the rate in a window of the calibrated area A = (2 · kCalibratedHalfWidthPx · gsd_m)²; the places
/// that deceive lie anywhere in it with the same density, and the ellipse does not know where. So the track may itself
/// be false: the rate holds as long as the ground behind the track is not the ground of this frame. A candidate that is
/// the best of several maps is there that many times as often.
double false_confirmation_rate(double evidence, const Eigen::Matrix2d& covariance_m2, double gsd_m);

inline constexpr double kAgreementShare = 0.99;
inline constexpr double kAgreementChiSquared = 9.210340371976182;  ///< −2 ln(1 − kAgreementShare)

}  // namespace pilotage

#pragma GCC visibility pop
