#pragma once

#include <array>

#include <Eigen/Core>

#include "pilotage/ins/ins_state.h"

namespace pilotage {

/// The position's covariance at one instant, of the covariances of an earlier one: two rows of the transition between
/// them, and what is added on the way. A tenth of the work of propagate() for many states.
class PositionAhead {
 public:
  using Rows = Eigen::Matrix<double, InsState::kSize, 2>;  ///< Those of the transition, one beside the other.

  /// After a step without an aiding velocity, flown straight on.
  explicit PositionAhead(const InsStep& step);
  PositionAhead(const Rows& rows, const Eigen::Matrix2d& noise_m2);

  const Rows& rows() const { return rows_; }
  const Eigen::Matrix2d& noise_m2() const { return noise_m2_; }
  Eigen::Matrix2d covariance_m2(const InsState::Covariance& covariance) const;

 private:
  Rows rows_;
  Eigen::Matrix2d noise_m2_;
  std::array<int, InsState::kSize> used_{};  // rows that are not 0
  int used_count_ = 0;
};

/// A way without GNSS or aiding velocity, for many states that fly it alike and of which none is flown step by step:
/// the covariance C of each stays as it was at the way's begin. With Ψ the transition from there and Q what was added
/// since, that at the way's end is Ψ C Ψᵀ + Q, of which a position asks for two rows. The same as propagate() over its
/// steps but for rounding, as long as it is not is_long().
class InsSpan {
 public:
  /// A way that begins with a state's heading and speed, and has not been flown yet.
  explicit InsSpan(const InsState& begin);

  /// Longer by a step without an aiding velocity.
  void fly(const InsStep& step);

  bool is_flown() const { return is_flown_; }
  double dt_s() const { return dt_s_; }
  /// Whether another span should begin: further on, Ψ⁻¹ costs digits.
  bool is_long() const;

  /// The state at the end of one of the begin.
  InsState end_of(const InsState& begin) const;
  /// The span as one step of one part, flown from the heading and speed of its end; for which model is not known.
  InsStep as_step() const;
  /// The position at the end, and at the end of what is flown from there.
  PositionAhead position() const;
  PositionAhead position_after(const PositionAhead& ahead) const;

 private:
  friend class SpanFix;
  double heading_deg_;
  double speed_mps_;
  bool is_flown_ = false;
  double dt_s_ = 0;
  InsState::Covariance transposed_ = InsState::Covariance::Identity();  // Ψᵀ
  InsState::Covariance noise_ = InsState::Covariance::Zero();           // Q
};

/// A position fix at the end of a span (update_with_fix), taken by states of its begin: their covariance changes as if
/// it had been measured with h Ψ, where Ψ⁻¹ Q hᵀ joins C Ψᵀ hᵀ.
class SpanFix {
 public:
  SpanFix(const InsSpan& span, double fix_sigma_m);

  /// The covariance at the begin that makes the one after the fix at the end: symmetric to the bit.
  InsState::Covariance fixed(const InsState::Covariance& begin) const;

 private:
  PositionAhead::Rows rows_;    // (h Ψ)ᵀ
  PositionAhead::Rows joined_;  // Ψ⁻¹ Q hᵀ
  double variance_m2_;
};

}  // namespace pilotage
