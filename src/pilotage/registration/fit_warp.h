#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pilotage/registration/ties.h"
#include "pilotage/registration/warp_field.h"

#pragma GCC visibility push(default)

namespace pilotage {

struct Spread {
  double median = 0;
  double quantile_95 = 0;
  double largest = 0;
};

struct WarpFit {
  WarpField field;
  std::vector<std::uint8_t> outlier;  ///< One for each tie: 1 = does not agree with the field.
  std::int64_t outliers = 0;
  Spread residual_m;      ///< Of the finest ties that are no outliers: distance of their displacement from the field.
  Spread left_out_m;      ///< The same of ties predicted by a field that was fitted without them (five parts).
  Spread disagreement_m;  ///< Magnitude of the displacement over the known cells.
};

/// The smooth field that agrees with the ties, whatever a minority of them say: minimises
///   Σ_ties ρ(w |u(p) − d|² / σ²) + Σ |second differences of the control displacements|² / b²,
/// ρ = Cauchy's loss (P. W. Holland, R. E. Welsch, Comm. Stat. A6, 1977), w = min(1, ncc²/(1 − ncc²)) (the inverse
/// variance of a shift between pictures of this correlation, at most that of ncc = 0.71), σ = tie_sigma_px pixels of
/// the tie, b = bending_px of the finest; second differences along both axes and twice the mixed one (thin plate).
/// Solved by Ceres from a wide loss to the narrow one, so that a wrong tie does not decide where it starts. A tie is an
/// outlier when its residual exceeds 4 σ₁, σ₁ the larger of tie_sigma_px and 1.4826 · the median residual per axis, in
/// pixels of the ties.
///
/// Ties are left out in blocks of two control spacings, a fifth of the blocks at a time. The predicted σ² of the field
/// is what one more tie would show: σ₀² (1 + v), σ₀ = 1.4826 · the median residual per axis of good ties left out, v
/// the variance of the fit by the curvature of the same sum (five control points around, the ones beyond held). Ties
/// that were taken because they lie near the field (Tie::is_confirmed) have no part in residuals and σ₀.
///
/// `gsd_m`: that of the finest ties. Deterministic: one thread. Fewer than eight ties give a field that is
/// known nowhere. Throws UsageError for bad options.
WarpFit fit_warp(std::span<const Tie> ties, double gsd_m, const WarpOptions& options);

/// Median, 95 % quantile and largest; NaN without values.
Spread spread_of(const std::vector<double>& values);

}  // namespace pilotage

#pragma GCC visibility pop
