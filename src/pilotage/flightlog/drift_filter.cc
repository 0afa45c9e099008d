#include "pilotage/flightlog/drift_filter.h"

namespace pilotage {

DriftFilter::DriftFilter(const InsErrorModel& model, double heading_deg, double speed_mps)
    : model_(model), estimate_{initial_ins_state(model, heading_deg, speed_mps)} {}

void DriftFilter::fly_on(double dt_s, double heading_deg, double speed_mps) {
  estimate_ = propagate(estimate_, make_ins_step(dt_s, heading_deg, speed_mps, model_));
}

void DriftFilter::start(const Eigen::Vector2d& error_m, const Eigen::Matrix2d& covariance_m2) {
  InsState::Covariance& covariance = estimate_.state.covariance;
  covariance.topRows<2>().setZero();
  covariance.leftCols<2>().setZero();
  covariance.topLeftCorner<2, 2>() = covariance_m2;
  estimate_.errors.head<2>() = error_m;
}

void DriftFilter::update(const Eigen::Vector2d& measured_m, const Eigen::Matrix2d& covariance_m2) {
  estimate_ = update_with_position_error(estimate_, measured_m, covariance_m2);
}

}  // namespace pilotage
