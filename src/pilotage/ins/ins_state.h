#pragma once

#include <vector>

#include <Eigen/Core>

#include "pilotage/ins/ins_error_model.h"

namespace pilotage {

/// Covariance of the horizontal errors of an inertial system, in an east-north frame that moves with the aircraft (its
/// rotation over a leg is neglected). Order of the error states:
///   0–1   position east, north (m)
///   2–3   velocity east, north (m/s)
///   4–5   tilt (rad): the lean of the computed vertical towards east and north, so that d(velocity)/dt = g·tilt
///   6     heading (rad, clockwise)
///   7–8   accelerometer bias forward, right (m/s²)
///   9–10  gyro bias that tilts forward, right (rad/s)
///   11    gyro bias about the vertical, clockwise (rad/s)
///   12    accelerometer scale error, 13 gyro scale error (fractions)
///   14–15 error of the aiding velocity east, north (m/s), or with visual odometry the drift along and across the track
///         as fractions of the distance
///   16–17 error of the map's georeference east, north (m), which every fix has in common with those of its
///   surroundings
/// Method: linear error-state propagation, docs/methods/ins.md; the equations are the horizontal channels of the
/// ψ-angle error model (D. Titterton, J. Weston, Strapdown Inertial Navigation Technology, 2nd ed., 2004, ch. 12; P.
/// Groves, Principles of GNSS, Inertial, and Multisensor Integrated Navigation Systems, 2nd ed., 2013, ch. 14).
struct InsState {
  static constexpr int kSize = 18;
  /// Where they begin.
  enum Index : int {
    kPosition = 0,
    kVelocity = 2,
    kTilt = 4,
    kHeading = 6,
    kAccelBias = 7,
    kGyroBias = 9,
    kGyroBiasZ = 11,
    kAccelScale = 12,
    kGyroScale = 13,
    kAid = 14,
    kMap = 16
  };
  using Covariance = Eigen::Matrix<double, kSize, kSize>;

  Covariance covariance = Covariance::Zero();
  double heading_deg = 0;  ///< Direction of flight, clockwise from north, at the end of the last step.
  double speed_mps = 0;    ///< At the end of the last step.
  double time_s = 0;
};

/// The state when GNSS is lost (position error start_sigma_m), flying in direction `heading_deg` at `speed_mps`. Errors
/// are uncorrelated, which for tilt and accelerometer bias is cautious: an alignment in flight leaves them partly
/// cancelled.
InsState initial_ins_state(const InsErrorModel& model, double heading_deg, double speed_mps);

/// The state `dt_s` seconds later, flown at `heading_deg` and `speed_mps`; a change of either happens at the start of
/// the step (the shorter way round). Exact in dt for constant heading and speed but for terms below 1e-9 of the result;
/// with an aiding velocity, steps are split so that the fusion is settled (below 1 s). Throws UsageError unless dt_s is
/// in [0, 1e6], the speed in [0, 1e4] and all are finite.
InsState propagate(const InsState& state, double dt_s, double heading_deg, double speed_mps,
                   const InsErrorModel& model);

/// A step of straight flight worked out once for the many states that fly it: propagate(state, step) gives the very
/// bits of propagate(state, step.dt_s, …). Throws as propagate.
struct InsStep {
  double dt_s = 0;
  double heading_deg = 0;
  double speed_mps = 0;
  bool odometry = false;     ///< Of the model it was made for.
  bool aided = false;        ///< An aiding velocity is used after each of `parts`.
  double parts = 0;          ///< The step is flown in this many equal parts; 0 when dt_s = 0.
  InsState::Covariance phi;  ///< Transition over one part.
  /// What of `phi` is not 0, in the rows of the states that others drive.
  struct Entry {
    int row = 0;
    int col = 0;
    double value = 0;
  };
  std::vector<Entry> driving;
  InsState::Covariance noise;  ///< What one part adds.

  /// States before this one are driven by others; from it on they drive, and only decay themselves.
  static constexpr int kDriven = InsState::kAccelBias;
  static constexpr int kDriving = InsState::kSize - kDriven;
  void list_driving();  ///< Fills `driving` from `phi`.
};
InsStep make_ins_step(double dt_s, double heading_deg, double speed_mps, const InsErrorModel& model);
InsState propagate(const InsState& state, const InsStep& step);

/// Φ P Φᵀ and what is added over one of the step's parts, without its aiding velocity: symmetric to the bit.
InsState::Covariance covariance_after_part(const InsState::Covariance& covariance, const InsStep& step);

/// What a position fix measures of the errors: that of the position less that of the map.
Eigen::Matrix<double, 2, InsState::kSize> fix_by_map();

/// Kalman update of a covariance (Joseph form, multiplied out) with a measurement of h · errors; returns the gain.
Eigen::Matrix<double, InsState::kSize, 2> update_covariance(InsState::Covariance& covariance,
                                                            const Eigen::Matrix<double, 2, InsState::kSize>& h,
                                                            const Eigen::Matrix2d& noise);

/// Kalman update with a position fix of error `fix_sigma_m` on each axis beside the map's. Each fix bounds the position
/// error, but never below the map's, and several also bound velocity, tilt and biases. Throws UsageError unless
/// fix_sigma_m is positive and finite.
InsState update_with_fix(const InsState& state, double fix_sigma_m);

/// An inertial system's errors as fixes of known places tell them: what InsState does not need, for it predicts.
struct InsEstimate {
  using Errors = Eigen::Matrix<double, InsState::kSize, 1>;

  InsState state;
  Errors errors = Errors::Zero();  ///< Expected, in the order of InsState: computed minus true for the position.
};

/// What a change of heading and speed at one instant makes of the errors: this matrix times them.
InsState::Covariance manoeuvre_jump(double from_heading_deg, double from_speed_mps, double heading_deg,
                                    double speed_mps, bool odometry);

/// A change of heading and speed at one instant: what a turn and an acceleration do to the errors, of which `errors`,
/// if not null, are those that there are.
void manoeuvre(InsState& state, double heading_deg, double speed_mps, bool odometry,
               InsEstimate::Errors* errors = nullptr);

/// The estimate after a step; its covariance is that of propagate(state, step) to the bit.
InsEstimate propagate(const InsEstimate& estimate, const InsStep& step);

/// Kalman update (Joseph form) with a measurement of the position's error; what is in `covariance_m2` of the map's own
/// error is taken for noise.
InsEstimate update_with_position_error(const InsEstimate& estimate, const Eigen::Vector2d& measured_m,
                                       const Eigen::Matrix2d& covariance_m2);

/// What GNSS does to the errors while it is had, flying in direction `heading_deg` at `speed_mps` (a change of either
/// happens before): position, velocity, tilt and heading are known at least to the model's figures for the loss of
/// GNSS (start_sigma_m and so on), along every axis. What is known better stays. Each error that is larger takes a
/// Kalman update whose noise leaves just that figure, so the other errors learn as much as holding this one takes, and
/// no more; a figure of 0 that is not the position's says nothing and holds nothing. The covariance never grows by it.
InsState hold_with_gnss(const InsState& state, double heading_deg, double speed_mps, const InsErrorModel& model);

/// k times the standard deviation of position along the worst direction (largest axis of the error ellipse): a circle
/// of this radius holds the error with 98.9 % (round ellipse) to 99.7 % (thin one) for k = 3.
double position_error_m(const InsState& state, double sigma_multiple);
double position_error_m(const Eigen::Matrix2d& position_covariance_m2, double sigma_multiple);

/// k times the standard deviations of attitude.
struct AttitudeError {
  double tilt_rad = 0;  ///< Of the vertical, along the worst direction.
  double heading_rad = 0;
};
AttitudeError attitude_error(const InsState& state, double sigma_multiple);

}  // namespace pilotage
