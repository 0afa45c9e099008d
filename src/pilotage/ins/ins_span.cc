#include "pilotage/ins/ins_span.h"

#include <cassert>
#include <cmath>

#include <Eigen/LU>

namespace pilotage {
namespace {

using enum InsState::Index;
using Matrix = InsState::Covariance;
using Rows = PositionAhead::Rows;

constexpr double kLongest_s = 60;
constexpr double kLeastDecay = 1e-3;  // of a state that only decays

// Eigen's products for large matrices are slower here than plain loops.
Eigen::Matrix2d added_m2(const Rows& rows, const Matrix& noise) {
  const Rows driven = noise.lazyProduct(rows);
  return rows.transpose().lazyProduct(driven);
}

}  // namespace

PositionAhead::PositionAhead(const Rows& rows, const Eigen::Matrix2d& noise_m2) : rows_(rows), noise_m2_(noise_m2) {
  for (int k = 0; k < InsState::kSize; ++k) {
    if (rows(k, 0) != 0 || rows(k, 1) != 0) used_[static_cast<std::size_t>(used_count_++)] = k;
  }
}

PositionAhead::PositionAhead(const InsStep& step) : PositionAhead(Rows::Identity(), Eigen::Matrix2d::Zero()) {
  assert(!step.aided);
  for (double part = 0; part < step.parts; ++part) {
    *this = PositionAhead(step.phi.transpose().lazyProduct(rows_), noise_m2_ + added_m2(rows_, step.noise));
  }
}

Eigen::Matrix2d PositionAhead::covariance_m2(const InsState::Covariance& covariance) const {
  double xx = noise_m2_(0, 0);
  double xy = noise_m2_(0, 1);
  double yy = noise_m2_(1, 1);
  for (int n = 0; n < used_count_; ++n) {
    const int k = used_[static_cast<std::size_t>(n)];
    double along_x = 0;
    double along_y = 0;
    for (int m = n + 1; m < used_count_; ++m) {
      const int j = used_[static_cast<std::size_t>(m)];
      along_x += covariance(j, k) * rows_(j, 0);
      along_y += covariance(j, k) * rows_(j, 1);
    }
    const double x = rows_(k, 0);
    const double y = rows_(k, 1);
    xx += x * (x * covariance(k, k) + 2 * along_x);
    xy += x * y * covariance(k, k) + x * along_y + y * along_x;
    yy += y * (y * covariance(k, k) + 2 * along_y);
  }
  return (Eigen::Matrix2d() << xx, xy, xy, yy).finished();
}

InsSpan::InsSpan(const InsState& begin) : heading_deg_(begin.heading_deg), speed_mps_(begin.speed_mps) {}

void InsSpan::fly(const InsStep& step) {
  assert(!step.aided);
  if (step.heading_deg != heading_deg_ || step.speed_mps != speed_mps_) {
    const Matrix jump = manoeuvre_jump(heading_deg_, speed_mps_, step.heading_deg, step.speed_mps, step.odometry);
    transposed_ = (transposed_ * jump.transpose()).eval();
    noise_ = (jump * noise_ * jump.transpose()).eval();
    heading_deg_ = step.heading_deg;
    speed_mps_ = step.speed_mps;
  }
  for (double part = 0; part < step.parts; ++part) {
    Matrix next;
    next.leftCols<InsStep::kDriven>().setZero();
    for (const InsStep::Entry& e : step.driving) next.col(e.row) += e.value * transposed_.col(e.col);
    for (int k = InsStep::kDriven; k < InsState::kSize; ++k) next.col(k) = step.phi(k, k) * transposed_.col(k);
    transposed_ = next;
    noise_ = covariance_after_part(noise_, step);
  }
  is_flown_ = true;
  dt_s_ += step.dt_s;
}

bool InsSpan::is_long() const {
  return dt_s_ > kLongest_s || transposed_.diagonal().tail<InsStep::kDriving>().minCoeff() < kLeastDecay;
}

InsState InsSpan::end_of(const InsState& begin) const {
  InsState end = begin;
  if (is_flown_) end.covariance = covariance_after_part(begin.covariance, as_step());
  end.heading_deg = heading_deg_;
  end.speed_mps = speed_mps_;
  end.time_s += dt_s_;
  return end;
}

InsStep InsSpan::as_step() const {
  InsStep step;
  step.dt_s = dt_s_;
  step.heading_deg = heading_deg_;
  step.speed_mps = speed_mps_;
  step.parts = 1;
  step.phi = transposed_.transpose();
  step.noise = noise_;
  step.list_driving();
  return step;
}

PositionAhead InsSpan::position() const {
  return {transposed_.leftCols<2>(), noise_.topLeftCorner<2, 2>()};
}

PositionAhead InsSpan::position_after(const PositionAhead& ahead) const {
  const Rows& rows = ahead.rows();
  return {transposed_.lazyProduct(rows), ahead.noise_m2() + added_m2(rows, noise_)};
}

SpanFix::SpanFix(const InsSpan& span, double fix_sigma_m) : variance_m2_(fix_sigma_m * fix_sigma_m) {
  const Rows measured = fix_by_map().transpose();
  rows_ = span.transposed_.lazyProduct(measured);
  joined_ = span.noise_.lazyProduct(measured);
  if (!span.is_flown()) return;  // Q is 0
  // Ψ has two blocks of rows: the lower one is a diagonal, and beside it there is nothing.
  const Matrix transition = span.transposed_.transpose();
  joined_.bottomRows<InsStep::kDriving>().array().colwise() /= transition.diagonal().tail<InsStep::kDriving>().array();
  joined_.topRows<InsStep::kDriven>() -= transition.topRightCorner<InsStep::kDriven, InsStep::kDriving>().lazyProduct(
      joined_.bottomRows<InsStep::kDriving>());
  const Eigen::Matrix<double, InsStep::kDriven, 2> driven =
      transition.topLeftCorner<InsStep::kDriven, InsStep::kDriven>().partialPivLu().solve(
          joined_.topRows<InsStep::kDriven>());
  joined_.topRows<InsStep::kDriven>() = driven;
}

InsState::Covariance SpanFix::fixed(const InsState::Covariance& begin) const {
  Rows ph = joined_;
  for (int k = 0; k < InsState::kSize; ++k) {
    if (rows_(k, 0) == 0 && rows_(k, 1) == 0) continue;
    ph.col(0) += rows_(k, 0) * begin.col(k);
    ph.col(1) += rows_(k, 1) * begin.col(k);
  }
  // With L Lᵀ the innovation's covariance, what is learnt is W Wᵀ, W = P hᵀ L⁻ᵀ.
  const double xx = rows_.col(0).dot(ph.col(0)) + variance_m2_;
  const double xy = rows_.col(0).dot(ph.col(1));
  const double yy = rows_.col(1).dot(ph.col(1)) + variance_m2_;
  const double first = std::sqrt(xx);
  const double beside = xy / first;
  const double second = std::sqrt(yy - beside * beside);
  Rows learnt;
  learnt.col(0) = ph.col(0) / first;
  learnt.col(1) = (ph.col(1) - beside * learnt.col(0)) / second;
  Matrix after;
  for (int j = 0; j < InsState::kSize; ++j) {
    after.col(j) = begin.col(j) - (learnt(j, 0) * learnt.col(0) + learnt(j, 1) * learnt.col(1));
  }
  return after;
}

}  // namespace pilotage
