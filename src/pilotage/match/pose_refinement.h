#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

namespace pilotage {

/// A point of the ground as the frame shows it and as the map has it. Metres; x and y are right and up in the map's
/// grid.
struct GroundPair {
  /// From the camera to where the prior attitude and height put the point: z = −height above ground.
  Eigen::Vector3d ray_m{0, 0, -1};
  Eigen::Vector2d map_m{0, 0};
  double rise_m = 0;  ///< Height of the map's ground there above that under the aircraft.
};

/// Of the errors that pairs share: docs/methods/match.md has what they were fitted to.
inline constexpr double kPairsPerIndependentPair = 8;
inline constexpr double kLeanSigma_px = 0.64;
inline constexpr double kLeanLength_px = 64;
inline constexpr double kHeightErrorLength_m = 100;

/// How sure the prior pose is, and what the map says of the ground.
struct PosePrior {
  Eigen::Matrix2d position_covariance_m2 = Eigen::Matrix2d::Identity();  ///< Right and up in the map's grid.
  double tilt_sigma_rad = 0.02;
  double yaw_sigma_rad = 0.02;
  double log_height_sigma = 0.03;
  double lean_sigma_m = 0;    ///< Of what neighbouring pairs are off by together, along each axis:
  double lean_length_m = 1;   ///< its likeness falls as a Gaussian of this. kLeanSigma_px, kLeanLength_px.
  double height_sigma_m = 0;  ///< Of the heights behind GroundPair::rise_m.
  /// How many times as far pairs, and what they share, are off as they would be if each was the ground's: chance pairs
  /// fit any pose.
  double pair_error_factor = 1;
  /// Of what pairs are off by, each by itself, along each axis, where that is known: then nothing is estimated from the
  /// residuals, all pairs are independent, and two are enough.
  std::optional<double> pair_sigma_m{};
};

/// The aircraft's pose against the prior one: what the frame says.
struct PoseCorrection {
  Eigen::Vector2d position_m{0, 0};  ///< Of the aircraft, in the frame of GroundPair::map_m.
  Eigen::Vector2d tilt_rad{0, 0};    ///< Rotation vector about x and y.
  double turn_rad = 0;               ///< About up: counter-clockwise.
  double log_height = 0;             ///< ln of height over the prior's.
  /// In the order position x, y, tilt x, y, turn, log height.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  double residual_m = 0;  ///< Root mean square along one axis of the pairs that agree.
  int inliers = 0;        ///< Pairs within three times the noise.
  bool converged = false;

  /// Where the corrected pose sees a ray of the prior pose on ground that rises by `rise_m`.
  Eigen::Vector2d ground_from_ray(const Eigen::Vector3d& ray_m, double rise_m = 0) const;
  /// Its derivatives by the six unknowns, in the order of `covariance`.
  Eigen::Matrix<double, 2, 6> ground_jacobian(const Eigen::Vector3d& ray_m, double rise_m = 0) const;
};

/// Fits the pose to pairs by least squares over six unknowns with ceres::TinySolver: residuals on the ground under
/// Cauchy's loss, and the prior attitude and height as further residuals (S. Agarwal, K. Mierle, Ceres Solver; P. J.
/// Huber, "Robust Statistics", 1981). `start_m` is the position to start from. The noise of a pair is estimated from
/// the residuals (their median); `floor_m` is the least noise believed.
///
/// The covariance of that is S⁻¹ E S⁻¹, with the solver's information S and the covariance E of what it was given: the
/// noise of the pairs, of which only one in kPairsPerIndependentPair is independent, for patches overlap; errors of the
/// map's points that neighbours share, for ground looks otherwise in patches on another day (PosePrior::lean_sigma_m
/// along each axis, falling as a Gaussian of lean_length_m), both times PosePrior::pair_error_factor; errors of the
/// map's heights likewise
/// (PosePrior::height_sigma_m, kHeightErrorLength_m); and the prior. Residuals do not show what is shared: tilt follows
/// it (docs/methods/match.md). Then the prior position is joined with what the frame says, each by its covariance, so
/// without_prior() gets back the latter. Not converged with fewer than four pairs (two with a
/// PosePrior::pair_sigma_m) or when numbers are not finite. Never
/// throws but std::bad_alloc.
PoseCorrection refine_pose(const std::vector<GroundPair>& pairs, const PosePrior& prior,
                           const Eigen::Vector2d& prior_position_m, const Eigen::Vector2d& start_m, double floor_m);

}  // namespace pilotage
