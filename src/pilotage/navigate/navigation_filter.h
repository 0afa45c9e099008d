#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "pilotage/ins/ins_error_model.h"
#include "pilotage/match/match.h"
#include "pilotage/match/position_measurement.h"
#include "pilotage/navigate/navigation_covariance.h"
#include "pilotage/navigate/navigation_options.h"
#include "pilotage/navigate/strapdown.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// Where the aircraft is believed to be. East and north are those of the place.
struct NavigationEstimate {
  double time_s = 0;
  GeodeticPoint position;
  double height_m = 0;  ///< Above the ellipsoid.
  Eigen::Vector3d velocity_enu_mps = Eigen::Vector3d::Zero();
  Attitude attitude;
  Eigen::Matrix2d covariance_en_m2 = Eigen::Matrix2d::Zero();  ///< Of position, against the ground, not the map.
  Eigen::Vector3d gyro_bias_radps = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel_bias_mps2 = Eigen::Vector3d::Zero();
  double barometer_error_m = 0;
  Eigen::Vector2d map_error_en_m = Eigen::Vector2d::Zero();
};

/// What became of a measurement.
enum class FixOutcome {
  kTaken,
  kRefused,    ///< Beyond the gate: it contradicts the filter.
  kReset,      ///< It contradicts the filter and agrees with those refused before: they are believed, it is taken.
  kForgotten,  ///< The frame is not known: it was answered before, or too many were taken after it.
  kUnusable,   ///< Not finite, or no covariance.
};

struct FixUpdate {
  FixOutcome outcome = FixOutcome::kUnusable;
  Eigen::Vector2d innovation_m = Eigen::Vector2d::Zero();  ///< Predicted minus measured, east and north.
  /// χ² of two degrees of freedom when the filter is honest; 0 for kForgotten and kUnusable.
  double normalized_innovation_squared = 0;
};

/// A number for a frame that is taken; those of a filter ascend from 0.
using FrameNumber = std::int64_t;

/// Inertial navigation corrected by position fixes, closed loop: the mechanisation flies with its estimated errors
/// taken out, and a Kalman filter carries the covariance of what is left (navigation_covariance.h). A fix is one of the
/// *map*, whose georeference is off by a slowly varying error that many fixes over the same ground share, so they do
/// not make the filter over-confident. docs/methods/navigate.md.
///
/// A loop: advance() with every increment of the IMU; at an exposure take_frame() and match_prior(); when match() has
/// answered, however late, take_fix() with what without_prior() made of it. Nothing is allocated and nothing thrown but
/// by the constructor. One thread at a time.
class NavigationFilter {
 public:
  /// `start` is where the aircraft is believed to be when GNSS is lost; how far off that may be says the model. Throws
  /// UsageError for a model of visual odometry, options outside their ranges, and a start that is not finite or not
  /// within 100 km of the ellipsoid.
  NavigationFilter(const InsErrorModel& model, const NavigationOptions& options, const InertialState& start);

  /// Flies on. False, and nothing changes, for an increment that is not finite or whose dt_s is not in (0, 1].
  bool advance(const ImuIncrement& increment);

  /// Remembers the state as that of a frame that is exposed now. Beyond NavigationErrors::kMostFrames of them the
  /// oldest is forgotten.
  FrameNumber take_frame();

  /// What match() is told of a frame: where it was taken, by the map's own georeference. Nothing for a forgotten frame.
  std::optional<MatchPrior> match_prior(FrameNumber frame, double height_agl_m) const;

  /// Takes what a frame alone says of the position; its covariance is with the map's own error, as without_prior()
  /// gives it, at least a millionth of which must be left when that is taken off: as much of it as
  /// NavigationOptions::map_sigma_m, which the filter has a state for, and the rest counts as noise.
  FixUpdate take_fix(FrameNumber frame, const PositionMeasurement& measurement);

  /// Takes a barometric height above the ellipsoid. False for one that is not finite.
  bool take_height(double height_m);

  /// Takes a velocity over ground, east and north, of an airspeed with a wind, an odometer, a Doppler radar: the mean
  /// over `over_s` seconds, with the model's velocity_aid_sigma_mps. False where it is not finite, `over_s` is not
  /// positive or the model has no aiding velocity.
  bool take_velocity(const Eigen::Vector2d& velocity_en_mps, double over_s);

  NavigationEstimate estimate() const;
  const InertialState& state() const { return state_; }
  /// Of the errors at state().time_s.
  const NavigationErrors::Covariance& covariance();
  /// Of the estimated sensors' and aids' errors, in the order of NavigationErrors; 0 for the others.
  const NavigationErrors::Vector& sensor_errors() const { return sensor_errors_; }

 private:
  struct Frame {
    FrameNumber number = -1;                             ///< −1: free.
    GeodeticPoint origin;                                ///< Where it was thought to be taken, then.
    Eigen::Vector2d offset_m = Eigen::Vector2d::Zero();  ///< By the map, from there, by what is known since.
    Attitude attitude;
  };
  /// The last fix that was refused.
  struct Refusal {
    Eigen::Vector2d innovation_m = Eigen::Vector2d::Zero();
    Eigen::Matrix2d covariance_m2 = Eigen::Matrix2d::Zero();
    int in_a_row = 0;
  };

  void catch_up();
  void correct(const NavigationErrors::Vector& errors);
  const Frame* find(FrameNumber frame) const;
  bool agrees_with_refused(const Eigen::Vector2d& innovation_m, const Eigen::Matrix2d& covariance_m2);
  void doubt(const Eigen::Vector2d& innovation_m);

  InsErrorModel model_;
  NavigationOptions options_;
  InertialState state_;
  ImuIncrement before_;
  FlownIntegrals flown_;  ///< Since the covariance was propagated last.
  NavigationErrors::Covariance covariance_;
  NavigationErrors::Vector sensor_errors_ = NavigationErrors::Vector::Zero();
  std::array<Frame, NavigationErrors::kMostFrames> frames_;
  FrameNumber next_frame_ = 0;
  Refusal refusal_;
  double last_taken_s_ = 0;
};

}  // namespace pilotage

#pragma GCC visibility pop
