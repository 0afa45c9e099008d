#pragma once

#include <Eigen/Core>

#include "pilotage/base/random.h"
#include "pilotage/ins/ins_state.h"

namespace pilotage {

/// The errors that one flight really has, drawn, and what its filter believes of them. The filter is closed-loop: what
/// it has learnt is taken out, so `errors` are what is left, estimated minus true, in the order of InsState. It is the
/// filter of navigate/ at a coarse rate: the horizontal channels alone, from one sample of the route to the next by the
/// exact transition of ins/ (docs/methods/simulate.md).
struct DrawnErrors {
  using Vector = InsEstimate::Errors;

  InsState believed;
  Vector errors = Vector::Zero();
  /// False: the map is not off, and the filter reckons with it all the same.
  bool map_is_off = true;

  Eigen::Vector2d position_error_m() const { return errors.segment<2>(InsState::kPosition); }
  Eigen::Matrix2d position_covariance_m2() const { return believed.covariance.topLeftCorner<2, 2>(); }
};

/// At the loss of GNSS, flying in direction `heading_deg`.
DrawnErrors draw_errors(const InsErrorModel& model, bool map_is_off, double heading_deg, double speed_mps,
                        Random& random);

/// What GNSS does where it is had, as hold_with_gnss() of ins/ does to the covariance: a measurement of each error that
/// is larger than the model's figure for the loss of GNSS leaves just that.
void hold_by_gnss(DrawnErrors& drawn, const InsErrorModel& model, Random& random);

/// A step whose noise can be drawn.
struct DrawnStep {
  explicit DrawnStep(const InsStep& step_to_draw);

  InsStep step;
  InsState::Covariance noise_root;  ///< Lower; noise_root · noise_rootᵀ is step.noise.
};

/// A lower triangular root of a covariance, which may be singular: columns of directions without variance are 0.
InsState::Covariance root_of(const InsState::Covariance& covariance);

void fly_step(DrawnErrors& drawn, const DrawnStep& step, Random& random);

/// Predicted minus measured position of a right fix, with its own error drawn.
Eigen::Vector2d innovation_of_fix(const DrawnErrors& drawn, double fix_sigma_m, Random& random);

/// The covariance of the innovation of a fix with this noise (the map's own error apart).
Eigen::Matrix2d innovation_covariance(const DrawnErrors& drawn, const Eigen::Matrix2d& noise_m2);

/// Kalman update, Joseph form.
void take_fix(DrawnErrors& drawn, const Eigen::Vector2d& innovation_m, const Eigen::Matrix2d& noise_m2);

}  // namespace pilotage
