#include "pilotage/navigate/navigation_filter.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "pilotage/base/error.h"
#include "pilotage/geo/ecef.h"
#include "pilotage/geo/local_frame.h"
#include "pilotage/geo/position_covariance.h"

namespace pilotage {
namespace {

using Errors = NavigationErrors;

/// How long the covariance may wait: the transition over this time is exact to 1e-4 at a turn of 20 °/s.
constexpr double kCovarianceStep_s = 0.5;

template <int kRows>
using Rows = Eigen::Matrix<double, kRows, Errors::kSize>;
template <int kRows>
using Square = Eigen::Matrix<double, kRows, kRows>;

/// Kalman update with a measurement z = h · errors + noise; what it says of the errors. Joseph form, multiplied out:
/// (I − K H) P (I − K H)ᵀ + K R Kᵀ.
template <int kRows>
Errors::Vector update(Errors::Covariance& p, const Rows<kRows>& h, const Square<kRows>& noise,
                      const Eigen::Matrix<double, kRows, 1>& z) {
  Eigen::Matrix<double, Errors::kSize, kRows> ph;
  ph.noalias() = p * h.transpose();
  const Square<kRows> innovation = h * ph + noise;
  const Square<kRows> inverse = innovation.inverse();
  const Eigen::Matrix<double, Errors::kSize, kRows> gain = ph * inverse;
  p.noalias() -= gain * ph.transpose();  // (I − K H) P
  const Eigen::Matrix<double, Errors::kSize, kRows> left = p * h.transpose();
  p.noalias() -= left * gain.transpose();
  const Eigen::Matrix<double, Errors::kSize, kRows> noisy = gain * noise;
  p.noalias() += noisy * gain.transpose();
  p = (0.5 * (p + p.transpose())).eval();
  return gain * z;
}

bool is_finite(const InertialState& state) {
  return std::isfinite(state.time_s) && state.position_m.allFinite() && state.velocity_mps.allFinite() &&
         state.ecef_from_body.coeffs().allFinite();
}

bool is_covariance(const Eigen::Matrix2d& m) {
  return m.allFinite() && m(0, 0) > 0 && m(1, 1) > 0 && m.determinant() > 0;
}

/// East and north of an ECEF vector at a place.
Eigen::Matrix<double, 2, 3> horizontal_at(GeodeticPoint point) {
  return enu_from_ecef(point).topRows<2>();
}

}  // namespace

NavigationFilter::NavigationFilter(const InsErrorModel& model, const NavigationOptions& options,
                                   const InertialState& start)
    : model_(model), options_(options), state_(start), last_taken_s_(start.time_s) {
  check_options(options);
  if (model.is_odometry()) {
    throw UsageError("a navigation filter integrates accelerations; visual-odometry has none: give an inertial grade");
  }
  if (!is_finite(start)) throw UsageError("the navigation filter's start is not finite");
  const double height_m = height_from_ecef(start.position_m, geodetic_from_ecef(start.position_m));
  if (!(std::abs(height_m) <= 1e5)) throw UsageError("the navigation filter's start is not within 100 km of the Earth");
  state_.ecef_from_body.normalize();
  covariance_ = initial_covariance(model, options, state_);
}

bool NavigationFilter::advance(const ImuIncrement& increment) {
  const double dt_s = increment.dt_s;
  if (!(dt_s > 0 && dt_s <= 1) || !increment.angle_rad.allFinite() || !increment.velocity_mps.allFinite()) return false;
  ImuIncrement now = increment;
  const auto part = [&](int first) { return sensor_errors_.segment<3>(first).array(); };
  now.angle_rad = ((now.angle_rad.array() - part(Errors::kGyroBias) * dt_s) / (1 + part(Errors::kGyroScale))).matrix();
  now.velocity_mps =
      ((now.velocity_mps.array() - part(Errors::kAccelBias) * dt_s) / (1 + part(Errors::kAccelScale))).matrix();
  const Eigen::Matrix3d first = state_.ecef_from_body.toRotationMatrix();
  state_ = pilotage::advance(state_, now, before_);
  before_ = now;

  const Eigen::Matrix3d mean = 0.5 * (first + state_.ecef_from_body.toRotationMatrix());
  flown_.dt_s += dt_s;
  flown_.attitude_s += mean * dt_s;
  flown_.force_mps += mean * now.velocity_mps;
  flown_.turned_rad += mean * now.angle_rad.asDiagonal();
  flown_.pushed_mps += mean * now.velocity_mps.asDiagonal();
  if (flown_.dt_s >= kCovarianceStep_s - 1e-9) catch_up();
  return true;
}

void NavigationFilter::catch_up() {
  if (!(flown_.dt_s > 0)) return;
  propagate(covariance_, flown_, state_, model_, options_);
  sensor_errors_ = sensor_errors_.cwiseProduct(error_decays(flown_, state_, model_, options_)).eval();
  flown_ = {};
}

const Errors::Covariance& NavigationFilter::covariance() {
  catch_up();
  return covariance_;
}

/// Takes expected errors out of the state.
void NavigationFilter::correct(const Errors::Vector& errors) {
  state_.position_m -= errors.segment<3>(Errors::kPosition);
  state_.velocity_mps -= errors.segment<3>(Errors::kVelocity);
  const Eigen::Vector3d turn_rad = -errors.segment<3>(Errors::kAttitude);
  const double angle_rad = turn_rad.norm();
  if (angle_rad > 0) {
    state_.ecef_from_body =
        (Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, turn_rad / angle_rad)) * state_.ecef_from_body).normalized();
  }
  constexpr int kSlow = Errors::kFrames - Errors::kGyroBias;
  sensor_errors_.segment<kSlow>(Errors::kGyroBias) -= errors.segment<kSlow>(Errors::kGyroBias);
  for (int i = 0; i < Errors::kMostFrames; ++i) {
    frames_[static_cast<std::size_t>(i)].offset_m -= errors.segment<2>(Errors::kFrames + 2 * i);
  }
}

FrameNumber NavigationFilter::take_frame() {
  catch_up();
  const auto slot = std::min_element(frames_.begin(), frames_.end(),
                                     [](const Frame& a, const Frame& b) { return a.number < b.number; });
  const int at = Errors::kFrames + 2 * static_cast<int>(slot - frames_.begin());
  const GeodeticPoint point = geodetic_from_ecef(state_.position_m);
  const Eigen::Vector2d map_m = sensor_errors_.segment<2>(Errors::kMap);
  *slot = {next_frame_++, point, map_m, attitude_of(state_)};

  Rows<2> h = Rows<2>::Zero();
  h.block<2, 3>(0, Errors::kPosition) = horizontal_at(point);
  h.block<2, 2>(0, Errors::kMap).setIdentity();
  h.block<2, 2>(0, at).setZero();
  Rows<2> rows;
  rows.noalias() = h * covariance_;
  const Eigen::Matrix2d own = rows * h.transpose();
  covariance_.middleRows<2>(at) = rows;
  covariance_.middleCols<2>(at) = rows.transpose();
  covariance_.block<2, 2>(at, at) = 0.5 * (own + own.transpose());
  return slot->number;
}

const NavigationFilter::Frame* NavigationFilter::find(FrameNumber frame) const {
  if (frame < 0) return nullptr;
  const auto found = std::find_if(frames_.begin(), frames_.end(), [&](const Frame& f) { return f.number == frame; });
  return found == frames_.end() ? nullptr : &*found;
}

std::optional<MatchPrior> NavigationFilter::match_prior(FrameNumber frame, double height_agl_m) const {
  const Frame* found = find(frame);
  if (found == nullptr) return std::nullopt;
  const int at = Errors::kFrames + 2 * static_cast<int>(found - frames_.data());
  MatchPrior prior;
  prior.position = LocalFrame(found->origin).geodetic_from_enu({found->offset_m.x(), found->offset_m.y(), 0});
  prior.covariance_en_m2 = covariance_.block<2, 2>(at, at);
  prior.height_agl_m = height_agl_m;
  prior.attitude = found->attitude;
  return prior;
}

FixUpdate NavigationFilter::take_fix(FrameNumber frame, const PositionMeasurement& measurement) {
  const Frame* found = find(frame);
  if (found == nullptr) return {FixOutcome::kForgotten, {}, 0};
  const auto slot = found - frames_.data();
  const int at = Errors::kFrames + 2 * static_cast<int>(slot);
  // What the map is off there beyond what the filter was told of it counts as noise of this fix.
  const double shared_sigma_m = std::min(measurement.map_sigma_m, options_.map_sigma_m);
  const Eigen::Matrix2d noise = measurement.covariance_en_m2 - isotropic_covariance_m2(shared_sigma_m);
  const bool on_earth = std::isfinite(measurement.position.lon_deg) && std::abs(measurement.position.lat_deg) <= 90;
  if (!on_earth || !is_covariance(noise) ||
      !(smallest_sigma_m(noise) > 1e-3 * smallest_sigma_m(measurement.covariance_en_m2))) {
    return {FixOutcome::kUnusable, {}, 0};
  }
  catch_up();
  FixUpdate result;
  result.innovation_m = found->offset_m - LocalFrame(found->origin).enu_from_geodetic(measurement.position).head<2>();
  result.normalized_innovation_squared =
      mahalanobis_squared(result.innovation_m, covariance_.block<2, 2>(at, at) + noise);
  result.outcome = FixOutcome::kTaken;
  if (!(result.normalized_innovation_squared <= kInnovationGateChiSquared)) {
    if (!agrees_with_refused(result.innovation_m, noise)) {
      frames_[static_cast<std::size_t>(slot)].number = -1;
      result.outcome = FixOutcome::kRefused;
      return result;
    }
    doubt(result.innovation_m);
    result.outcome = FixOutcome::kReset;
  }
  Rows<2> h = Rows<2>::Zero();
  h.block<2, 2>(0, at).setIdentity();
  correct(update<2>(covariance_, h, noise, result.innovation_m));
  frames_[static_cast<std::size_t>(slot)].number = -1;
  refusal_.in_a_row = 0;
  last_taken_s_ = state_.time_s;
  return result;
}

/// Counts a refused fix. True when it is the last of enough in a row that say the same.
bool NavigationFilter::agrees_with_refused(const Eigen::Vector2d& innovation_m, const Eigen::Matrix2d& covariance_m2) {
  // What the filter holds possible for its own error is also how far that may have changed between two fixes.
  const Eigen::Matrix<double, 2, 3> horizontal = horizontal_at(geodetic_from_ecef(state_.position_m));
  const Eigen::Matrix2d own =
      horizontal * covariance_.block<3, 3>(Errors::kPosition, Errors::kPosition) * horizontal.transpose();
  const bool same = refusal_.in_a_row > 0 &&
                    mahalanobis_squared(innovation_m - refusal_.innovation_m,
                                        covariance_m2 + refusal_.covariance_m2 + own) <= kInnovationGateChiSquared;
  refusal_ = {innovation_m, covariance_m2, same ? refusal_.in_a_row + 1 : 1};
  return refusal_.in_a_row >= options_.refusals_to_reset;
}

/// The filter was wrong by this much, and all the frames that wait are: since the last fix that it took.
void NavigationFilter::doubt(const Eigen::Vector2d& innovation_m) {
  const double most_m2 = innovation_m.squaredNorm();
  const double since_s = std::max(1.0, state_.time_s - last_taken_s_);
  const Eigen::Matrix<double, 2, 3> horizontal = horizontal_at(geodetic_from_ecef(state_.position_m));
  Eigen::Matrix<double, Errors::kSize, 2> off = Eigen::Matrix<double, Errors::kSize, 2>::Zero();
  off.block<3, 2>(Errors::kPosition, 0) = horizontal.transpose();
  for (int i = 0; i < Errors::kMostFrames; ++i) {
    if (frames_[static_cast<std::size_t>(i)].number >= 0) off.block<2, 2>(Errors::kFrames + 2 * i, 0).setIdentity();
  }
  covariance_.noalias() += most_m2 * off * off.transpose();
  covariance_.block<3, 3>(Errors::kVelocity, Errors::kVelocity) +=
      most_m2 / (since_s * since_s) * (horizontal.transpose() * horizontal);
}

bool NavigationFilter::take_height(double height_m) {
  if (!std::isfinite(height_m)) return false;
  catch_up();
  const GeodeticPoint point = geodetic_from_ecef(state_.position_m);
  Rows<1> h = Rows<1>::Zero();
  h.segment<3>(Errors::kPosition) = enu_from_ecef(point).row(2);
  h[Errors::kBarometer] = 1;
  const double predicted_m = height_from_ecef(state_.position_m, point) + sensor_errors_[Errors::kBarometer];
  const Square<1> noise(options_.barometer_noise_m * options_.barometer_noise_m);
  correct(update<1>(covariance_, h, noise, Square<1>(predicted_m - height_m)));
  return true;
}

bool NavigationFilter::take_velocity(const Eigen::Vector2d& velocity_en_mps, double over_s) {
  if (!velocity_en_mps.allFinite() || !(over_s > 0) || !(model_.velocity_aid_sigma_mps > 0)) return false;
  catch_up();
  const Eigen::Matrix<double, 2, 3> horizontal = horizontal_at(geodetic_from_ecef(state_.position_m));
  Rows<2> h = Rows<2>::Zero();
  h.block<2, 3>(0, Errors::kVelocity) = horizontal;
  h.block<2, 2>(0, Errors::kAid).setIdentity();
  const Eigen::Vector2d predicted_mps = horizontal * state_.velocity_mps + sensor_errors_.segment<2>(Errors::kAid);
  const double variance = kVelocityAidNoise_mps_rt_hz * kVelocityAidNoise_mps_rt_hz / over_s;
  correct(update<2>(covariance_, h, variance * Square<2>::Identity(), predicted_mps - velocity_en_mps));
  return true;
}

NavigationEstimate NavigationFilter::estimate() const {
  NavigationEstimate now;
  now.time_s = state_.time_s;
  now.position = geodetic_from_ecef(state_.position_m);
  now.height_m = height_from_ecef(state_.position_m, now.position);
  const Eigen::Matrix3d to_enu = enu_from_ecef(now.position);
  now.velocity_enu_mps = to_enu * state_.velocity_mps;
  now.attitude = attitude_of(state_);
  Errors::Covariance covariance = covariance_;
  if (flown_.dt_s > 0) propagate(covariance, flown_, state_, model_, options_);
  now.covariance_en_m2 = (to_enu * covariance.block<3, 3>(Errors::kPosition, Errors::kPosition) * to_enu.transpose())
                             .topLeftCorner<2, 2>();
  now.gyro_bias_radps = sensor_errors_.segment<3>(Errors::kGyroBias);
  now.accel_bias_mps2 = sensor_errors_.segment<3>(Errors::kAccelBias);
  now.barometer_error_m = sensor_errors_[Errors::kBarometer];
  now.map_error_en_m = sensor_errors_.segment<2>(Errors::kMap);
  return now;
}

}  // namespace pilotage
