#include "pilotage/replay/grade_fit.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "pilotage/base/text.h"
#include "pilotage/flightlog/drift_filter.h"
#include "pilotage/flightlog/frame_track.h"

namespace pilotage {
namespace {

constexpr int kStepsPerOctave = 8;
constexpr int kOctaves = 5;  // 2^5 is kLargestGradeFactor
constexpr double kHalfChiSquared95 = 3.841458820694124 / 2;

/// What a factor makes of the innovations.
struct FactorScore {
  double log_likelihood = 0;
  double nis = 0;
  std::int64_t innovations = 0;
  double longest_gap_s = 0;
};

FrameRecord row_of(const ReplayedFrame& frame) {
  FrameRecord row;
  row.time_s = frame.time_s;
  row.prior = *frame.prior;
  row.attitude.yaw_deg = std::isfinite(frame.yaw_deg) ? frame.yaw_deg : 0;
  return row;
}

std::vector<const ReplayedFrame*> usable_frames(const ReplayedFlight& flight) {
  std::vector<const ReplayedFrame*> frames;
  for (const ReplayedFrame& frame : flight.frames) {
    if (frame.prior && std::isfinite(frame.time_s)) frames.push_back(&frame);
  }
  std::stable_sort(frames.begin(), frames.end(), [](const auto* a, const auto* b) { return a->time_s < b->time_s; });
  return frames;
}

void add_innovation(const DriftFilter& filter, const InertialError& measured, FactorScore& score) {
  const Eigen::Vector2d innovation_m = measured.error_m - filter.error_m();
  const Eigen::Matrix2d covariance = filter.covariance_m2() + measured.covariance_m2;
  const double nis = innovation_m.dot(covariance.inverse() * innovation_m);
  score.log_likelihood -= (std::log(covariance.determinant()) + nis) / 2;
  score.nis += nis;
  ++score.innovations;
}

void score_flight(const ReplayedFlight& flight, const InsErrorModel& model, FactorScore& score) {
  std::optional<DriftFilter> filter;
  const ReplayedFrame* before = nullptr;
  double fixed_s = 0;
  for (const ReplayedFrame* frame : usable_frames(flight)) {
    const FrameRecord row = row_of(*frame);
    const FrameMotion motion =
        before != nullptr ? motion_between(row_of(*before), row) : FrameMotion{0, row.attitude.yaw_deg, 0};
    before = frame;
    if (filter && motion.dt_s > 0) filter->fly_on(motion.dt_s, motion.heading_deg, motion.speed_mps);
    if (!frame->inertial_error || !frame->counts_as_right()) continue;
    const InertialError& measured = *frame->inertial_error;
    if (!filter) {
      filter.emplace(model, motion.heading_deg, motion.speed_mps);
      filter->start(measured.error_m, measured.covariance_m2);
    } else {
      add_innovation(*filter, measured, score);
      score.longest_gap_s = std::max(score.longest_gap_s, frame->time_s - fixed_s);
      filter->update(measured.error_m, measured.covariance_m2);
    }
    fixed_s = frame->time_s;
  }
}

FactorScore score_factor(std::span<const ReplayedFlight> flights, const InsErrorModel& model, double factor) {
  FactorScore score;
  const InsErrorModel scaled = scaled_model(model, factor);
  for (const ReplayedFlight& flight : flights) score_flight(flight, scaled, score);
  return score;
}

double factor_of_step(int step) {
  return std::exp2(static_cast<double>(step) / kStepsPerOctave);
}

/// Where the log likelihood, linear between two steps, falls to `limit`.
double crossing(int inside, int outside, double at_inside, double at_outside, double limit) {
  const double share = (at_inside - limit) / (at_inside - at_outside);
  return std::exp2((inside + share * (outside - inside)) / static_cast<double>(kStepsPerOctave));
}

}  // namespace

InsErrorModel scaled_model(InsErrorModel model, double factor) {
  for (double InsErrorModel::*figure :
       {&InsErrorModel::accel_bias_mps2, &InsErrorModel::gyro_bias_radps, &InsErrorModel::velocity_random_walk_mps_rt_s,
        &InsErrorModel::angle_random_walk_rad_rt_s, &InsErrorModel::accel_scale, &InsErrorModel::gyro_scale,
        &InsErrorModel::start_velocity_sigma_mps, &InsErrorModel::start_tilt_sigma_rad,
        &InsErrorModel::start_heading_sigma_rad, &InsErrorModel::odometry_drift,
        &InsErrorModel::velocity_aid_sigma_mps}) {
    model.*figure *= factor;
  }
  return model;
}

GradeFit fit_grade(std::span<const ReplayedFlight> flights, const InsErrorModel& model) {
  const FactorScore at_one = score_factor(flights, model, 1);
  GradeFit fit;
  fit.innovations = at_one.innovations;
  fit.longest_gap_s = at_one.longest_gap_s;
  if (fit.innovations > 0) {
    const auto count = static_cast<double>(fit.innovations);
    fit.mean_nis = at_one.nis / count;
    fit.nis_band = {chi_squared_quantile(0.025, 2 * count) / count, chi_squared_quantile(0.975, 2 * count) / count};
  }
  if (fit.innovations < kLeastInnovations) {
    fit.why_not = std::to_string(fit.innovations) +
                  " gaps between fixes with the inertial position say nothing; at least " +
                  std::to_string(kLeastInnovations) + " are needed";
    return fit;
  }
  constexpr int kMost = kStepsPerOctave * kOctaves;
  std::vector<double> likelihoods;
  for (int step = -kMost; step <= kMost; ++step) {
    likelihoods.push_back(score_factor(flights, model, factor_of_step(step)).log_likelihood);
  }
  const auto best = std::max_element(likelihoods.begin(), likelihoods.end());
  const auto at = static_cast<int>(best - likelihoods.begin());
  const double limit = *best - kHalfChiSquared95;
  for (int i = at; i > 0 && !fit.low; --i) {
    const auto index = static_cast<std::size_t>(i);
    if (likelihoods[index - 1] < limit) {
      fit.low = crossing(i - kMost, i - 1 - kMost, likelihoods[index], likelihoods[index - 1], limit);
    }
  }
  for (int i = at; i < 2 * kMost && !fit.high; ++i) {
    const auto index = static_cast<std::size_t>(i);
    if (likelihoods[index + 1] < limit) {
      fit.high = crossing(i - kMost, i + 1 - kMost, likelihoods[index], likelihoods[index + 1], limit);
    }
  }
  if (at > 0 && at < 2 * kMost) {
    fit.factor = factor_of_step(at - kMost);
  } else if (at == 0) {  // the best of all may lie beyond the end
    fit.why_not = "fixes do not tell its drift from none";
    if (fit.high) fit.why_not += "; it is below " + format_fixed(*fit.high, 2) + " times the model's";
  } else {
    fit.why_not = "errors between fixes are beyond " + format_fixed(kLargestGradeFactor, 0) +
                  " times the model's: fixes or inertial positions are not what they are taken for";
  }
  return fit;
}

}  // namespace pilotage
