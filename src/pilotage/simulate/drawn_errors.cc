#include "pilotage/simulate/drawn_errors.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

namespace pilotage {
namespace {

using Drawn = DrawnErrors;

template <int kCount>
Eigen::Matrix<double, kCount, 1> normals(Random& random) {
  Eigen::Matrix<double, kCount, 1> drawn;
  for (int i = 0; i < kCount; ++i) drawn[i] = random.normal();
  return drawn;
}

/// Kalman update with a measurement of h · errors that says `z`; Joseph form, multiplied out.
void update_drawn(Drawn& drawn, const Eigen::Matrix<double, 2, Drawn::kSize>& h, const Eigen::Vector2d& z,
                  const Eigen::Matrix2d& noise) {
  Drawn::Covariance& p = drawn.covariance;
  using Columns = Eigen::Matrix<double, Drawn::kSize, 2>;
  const Columns ph = p * h.transpose();
  const Columns gain = ph * Eigen::Matrix2d(h * ph + noise).inverse();
  p.noalias() -= gain * ph.transpose();
  const Columns left = p * h.transpose();
  p.noalias() -= left * gain.transpose();
  p.noalias() += gain * noise * gain.transpose();
  p = (0.5 * (p + p.transpose())).eval();
  drawn.errors -= gain * z;
}

/// A measurement of h · errors, its noise drawn, that leaves the variance `most`; nothing where it has no more. The
/// plan's: ins/ins_state.cc.
void hold_drawn(Drawn& drawn, const Drawn::Vector& h, double most, Random& random) {
  Drawn::Covariance& p = drawn.covariance;
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
  const Eigen::Matrix2d ellipse = drawn.covariance.block<2, 2>(first, first);
  const double angle_rad = 0.5 * std::atan2(2 * ellipse(0, 1), ellipse(0, 0) - ellipse(1, 1));
  for (const Eigen::Vector2d& axis : {Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad)),
                                      Eigen::Vector2d(-std::sin(angle_rad), std::cos(angle_rad))}) {
    Drawn::Vector h = Drawn::Vector::Zero();
    h.segment<2>(first) = axis;
    hold_drawn(drawn, h, most, random);
  }
}

Eigen::Matrix<double, 2, Drawn::kSize> position_by_map() {
  Eigen::Matrix<double, 2, Drawn::kSize> h = Eigen::Matrix<double, 2, Drawn::kSize>::Zero();
  h.block<2, 2>(0, 0).setIdentity();
  h.block<2, 2>(0, Drawn::kMap).setIdentity();
  return h;
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

DrawnErrors draw_errors(const InsErrorModel& model, const MapError& map, double heading_deg, double speed_mps,
                        Random& random) {
  DrawnErrors drawn;
  drawn.heading_deg = heading_deg;
  drawn.speed_mps = speed_mps;
  drawn.covariance.topLeftCorner<InsState::kSize, InsState::kSize>() =
      initial_ins_state(model, heading_deg, speed_mps).covariance;  // a diagonal
  drawn.covariance.block<2, 2>(Drawn::kMap, Drawn::kMap).diagonal().setConstant(map.sigma_m * map.sigma_m);
  drawn.errors = drawn.covariance.diagonal().cwiseSqrt().cwiseProduct(normals<Drawn::kSize>(random));
  if (!map.is_drawn) drawn.errors.tail<2>().setZero();
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

void fly_step(DrawnErrors& drawn, const DrawnStep& drawn_step, const MapError& map, Random& random) {
  const InsStep& step = drawn_step.step;
  Drawn::Covariance& p = drawn.covariance;
  const auto transform = [&](const InsState::Covariance& matrix, double map_decay) {
    auto own = p.topLeftCorner<InsState::kSize, InsState::kSize>();
    const InsState::Covariance rows = matrix * own;
    own.noalias() = rows * matrix.transpose();
    const Eigen::Matrix<double, InsState::kSize, 2> with_map =
        map_decay * (matrix * p.topRightCorner<InsState::kSize, 2>());
    p.topRightCorner<InsState::kSize, 2>() = with_map;
    p.bottomLeftCorner<2, InsState::kSize>() = with_map.transpose();
    drawn.errors.head<InsState::kSize>() = (matrix * drawn.errors.head<InsState::kSize>()).eval();
  };
  if (drawn.heading_deg != step.heading_deg || drawn.speed_mps != step.speed_mps) {
    transform(manoeuvre_jump(drawn.heading_deg, drawn.speed_mps, step.heading_deg, step.speed_mps, step.odometry), 1);
    drawn.heading_deg = step.heading_deg;
    drawn.speed_mps = step.speed_mps;
  }
  const double part_s = step.parts > 0 ? step.dt_s / step.parts : 0;
  const double decay = std::exp(-step.speed_mps * part_s / map.correlation_m);
  for (double i = 0; i < step.parts; ++i) {
    transform(step.phi, decay);
    p.topLeftCorner<InsState::kSize, InsState::kSize>() += step.noise;
    drawn.errors.head<InsState::kSize>() += drawn_step.noise_root * normals<InsState::kSize>(random);
    const double added = (1 - decay * decay) * map.sigma_m * map.sigma_m;
    p.block<2, 2>(Drawn::kMap, Drawn::kMap) *= decay * decay;
    p.block<2, 2>(Drawn::kMap, Drawn::kMap).diagonal().array() += added;
    const Eigen::Vector2d changed = std::sqrt(added) * normals<2>(random);
    drawn.errors.tail<2>() *= decay;
    if (map.is_drawn) drawn.errors.tail<2>() += changed;
    if (!step.aided) continue;
    Eigen::Matrix<double, 2, Drawn::kSize> h = Eigen::Matrix<double, 2, Drawn::kSize>::Zero();
    h.block<2, 2>(0, InsState::kVelocity).setIdentity();
    h.block<2, 2>(0, InsState::kAid) = -Eigen::Matrix2d::Identity();
    const double sigma_mps = kVelocityAidNoise_mps_rt_hz / std::sqrt(part_s);
    update_drawn(drawn, h, h * drawn.errors + sigma_mps * normals<2>(random),
                 sigma_mps * sigma_mps * Eigen::Matrix2d::Identity());
  }
}

Eigen::Vector2d innovation_of_fix(const DrawnErrors& drawn, double fix_sigma_m, Random& random) {
  return drawn.errors.head<2>() + drawn.errors.tail<2>() + fix_sigma_m * normals<2>(random);
}

Eigen::Matrix2d innovation_covariance(const DrawnErrors& drawn, const Eigen::Matrix2d& noise_m2) {
  const Eigen::Matrix<double, 2, Drawn::kSize> h = position_by_map();
  return h * drawn.covariance * h.transpose() + noise_m2;
}

void take_fix(DrawnErrors& drawn, const Eigen::Vector2d& innovation_m, const Eigen::Matrix2d& noise_m2) {
  update_drawn(drawn, position_by_map(), innovation_m, noise_m2);
}

}  // namespace pilotage
