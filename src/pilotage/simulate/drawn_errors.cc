#include "pilotage/simulate/drawn_errors.h"

#include <algorithm>
#include <cmath>

namespace pilotage {
namespace {

using Drawn = DrawnErrors;

template <int kCount>
Eigen::Matrix<double, kCount, 1> normals(Random& random) {
  Eigen::Matrix<double, kCount, 1> drawn;
  for (int i = 0; i < kCount; ++i) drawn[i] = random.normal();
  return drawn;
}

/// A measurement of h · errors, its noise drawn, that leaves the variance `most`; nothing where it has no more. The
/// plan's: ins/ins_state.cc.
void hold_drawn(Drawn& drawn, const Drawn::Vector& h, double most, Random& random) {
  InsState::Covariance& p = drawn.believed.covariance;
  const Drawn::Vector ph = p * h;
  const double variance = h.dot(ph);
  if (!(variance > most)) return;
  const double noise = most * variance / (variance - most);
  const Drawn::Vector gain = (variance - most) / (variance * variance) * ph;
  p -= gain * ph.transpose();
  p -= (p * h).eval() * gain.transpose();
  p += noise * gain * gain.transpose();
  p = (0.5 * (p + p.transpose())).eval();
  drawn.errors -= gain * (h.dot(drawn.errors) + std::sqrt(noise) * random.normal());
}

/// The same along both axes of the error ellipse of two errors.
void hold_pair_drawn(Drawn& drawn, int first, double most, Random& random) {
  const Eigen::Matrix2d ellipse = drawn.believed.covariance.block<2, 2>(first, first);
  const double angle_rad = 0.5 * std::atan2(2 * ellipse(0, 1), ellipse(0, 0) - ellipse(1, 1));
  for (const Eigen::Vector2d& axis : {Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad)),
                                      Eigen::Vector2d(-std::sin(angle_rad), std::cos(angle_rad))}) {
    Drawn::Vector h = Drawn::Vector::Zero();
    h.segment<2>(first) = axis;
    hold_drawn(drawn, h, most, random);
  }
}

}  // namespace

InsState::Covariance root_of(const InsState::Covariance& covariance) {
  InsState::Covariance root = InsState::Covariance::Zero();
  const double least = 1e-14;
  for (int j = 0; j < InsState::kSize; ++j) {
    const double variance = covariance(j, j) - root.row(j).head(j).squaredNorm();
    if (!(variance > least * covariance(j, j))) continue;
    root(j, j) = std::sqrt(variance);
    for (int i = j + 1; i < InsState::kSize; ++i) {
      root(i, j) = (covariance(i, j) - root.row(i).head(j).dot(root.row(j).head(j))) / root(j, j);
    }
  }
  return root;
}

DrawnStep::DrawnStep(const InsStep& step_to_draw) : step(step_to_draw), noise_root(InsState::Covariance::Zero()) {
  if (step.parts > 0) noise_root = root_of(step.noise);
}

DrawnErrors draw_errors(const InsErrorModel& model, bool map_is_off, double heading_deg, double speed_mps,
                        Random& random) {
  DrawnErrors drawn;
  drawn.believed = initial_ins_state(model, heading_deg, speed_mps);  // its covariance is a diagonal
  drawn.map_is_off = map_is_off;
  drawn.errors = drawn.believed.covariance.diagonal().cwiseSqrt().cwiseProduct(normals<InsState::kSize>(random));
  if (!map_is_off) drawn.errors.segment<2>(InsState::kMap).setZero();
  return drawn;
}

void hold_by_gnss(DrawnErrors& drawn, const InsErrorModel& model, Random& random) {
  const auto hold_pair = [&](int first, double sigma) {
    if (sigma > 0) hold_pair_drawn(drawn, first, sigma * sigma, random);
  };
  hold_pair(InsState::kPosition, model.start_sigma_m);
  hold_pair(InsState::kVelocity, model.start_velocity_sigma_mps);
  hold_pair(InsState::kTilt, model.start_tilt_sigma_rad);
  if (model.start_heading_sigma_rad > 0) {
    hold_drawn(drawn, Drawn::Vector::Unit(InsState::kHeading),
               model.start_heading_sigma_rad * model.start_heading_sigma_rad, random);
  }
}

void fly_step(DrawnErrors& drawn, const DrawnStep& drawn_step, Random& random) {
  const InsStep& step = drawn_step.step;
  InsState& believed = drawn.believed;
  InsState::Covariance& p = believed.covariance;
  manoeuvre(believed, step.heading_deg, step.speed_mps, step.odometry, &drawn.errors);
  const double part_s = step.parts > 0 ? step.dt_s / step.parts : 0;
  for (double i = 0; i < step.parts; ++i) {
    p = covariance_after_part(p, step);
    drawn.errors = (step.phi * drawn.errors + drawn_step.noise_root * normals<InsState::kSize>(random)).eval();
    if (!drawn.map_is_off) drawn.errors.segment<2>(InsState::kMap).setZero();
    if (!step.aided) continue;
    Eigen::Matrix<double, 2, InsState::kSize> h = Eigen::Matrix<double, 2, InsState::kSize>::Zero();
    h.block<2, 2>(0, InsState::kVelocity).setIdentity();
    h.block<2, 2>(0, InsState::kAid) = -Eigen::Matrix2d::Identity();
    const double sigma_mps = kVelocityAidNoise_mps_rt_hz / std::sqrt(part_s);
    const Eigen::Vector2d z = h * drawn.errors + sigma_mps * normals<2>(random);
    drawn.errors -= update_covariance(p, h, sigma_mps * sigma_mps * Eigen::Matrix2d::Identity()) * z;
  }
  believed.time_s += step.dt_s;
}

Eigen::Vector2d innovation_of_fix(const DrawnErrors& drawn, double fix_sigma_m, Random& random) {
  return fix_by_map() * drawn.errors + fix_sigma_m * normals<2>(random);
}

Eigen::Matrix2d innovation_covariance(const DrawnErrors& drawn, const Eigen::Matrix2d& noise_m2) {
  const Eigen::Matrix<double, 2, InsState::kSize> h = fix_by_map();
  return h * drawn.believed.covariance * h.transpose() + noise_m2;
}

void take_fix(DrawnErrors& drawn, const Eigen::Vector2d& innovation_m, const Eigen::Matrix2d& noise_m2) {
  drawn.errors -= update_covariance(drawn.believed.covariance, fix_by_map(), noise_m2) * innovation_m;
}

}  // namespace pilotage
