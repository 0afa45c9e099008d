#pragma once

#include <Eigen/Core>

#include "pilotage/ins/ins_error_model.h"
#include "pilotage/navigate/navigation_options.h"
#include "pilotage/navigate/strapdown.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// The errors that the navigation filter carries, each estimated minus true. Axes x, y, z are those of ECEF, or of the
/// body for the sensors.
///   0–2    position (m)              3–5    velocity (m/s)          6–8    attitude (rad): Ĉ = (I + [ψ×]) C
///   9–11   gyro bias (rad/s)         12–14  accelerometer bias (m/s²)
///   15–17  gyro scale (fraction)     18–20  accelerometer scale (fraction)
///   21     slow error of the barometer (m)
///   22–23  error of the map's georeference, east and north (m)
///   24–25  slow error of the aiding velocity, east and north (m/s)
///   26–33  of up to four frames that were taken and are not answered yet: position and map error together, east and
///          north, as they were at the exposure (stochastic clones)
struct NavigationErrors {
  static constexpr int kPosition = 0;
  static constexpr int kVelocity = 3;
  static constexpr int kAttitude = 6;
  static constexpr int kGyroBias = 9;
  static constexpr int kAccelBias = 12;
  static constexpr int kGyroScale = 15;
  static constexpr int kAccelScale = 18;
  static constexpr int kBarometer = 21;
  static constexpr int kMap = 22;
  static constexpr int kAid = 24;
  static constexpr int kFrames = 26;
  static constexpr int kMostFrames = 4;
  static constexpr int kSize = kFrames + 2 * kMostFrames;
  using Vector = Eigen::Matrix<double, kSize, 1>;
  using Covariance = Eigen::Matrix<double, kSize, kSize>;
};

/// What the inertial sensors said over a time, as far as the errors depend on it: integrals along ECEF axes.
struct FlownIntegrals {
  double dt_s = 0;
  Eigen::Matrix3d attitude_s = Eigen::Matrix3d::Zero();  ///< ∫ C dt
  Eigen::Vector3d force_mps = Eigen::Vector3d::Zero();   ///< ∫ C f dt
  Eigen::Matrix3d turned_rad = Eigen::Matrix3d::Zero();  ///< ∫ C diag(ω) dt
  Eigen::Matrix3d pushed_mps = Eigen::Matrix3d::Zero();  ///< ∫ C diag(f) dt
};

/// Covariance of the errors when GNSS is lost, with the model's figures, uncorrelated.
NavigationErrors::Covariance initial_covariance(const InsErrorModel& model, const NavigationOptions& options,
                                                const InertialState& state);

/// The factors by which expected errors change of themselves over the flight of `flown`: those of Gauss-Markov
/// processes decay, the others' factor is 1.
NavigationErrors::Vector error_decays(const FlownIntegrals& flown, const InertialState& state,
                                      const InsErrorModel& model, const NavigationOptions& options);

/// The covariance after the flight of `flown` (at most 1 s), which ends at `state`.
void propagate(NavigationErrors::Covariance& covariance, const FlownIntegrals& flown, const InertialState& state,
               const InsErrorModel& model, const NavigationOptions& options);

}  // namespace pilotage

#pragma GCC visibility pop
