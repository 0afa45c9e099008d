#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "pilotage/registration/ties.h"
#include "pilotage/registration/warp_field.h"

namespace pilotage {

/// The sum that fit_warp minimises, for a grid of control points. Control points far from every tie take no part: they
/// continue their neighbours.
struct WarpProblem {
  WarpField grid;                    ///< Place and size of the control points; their values are not looked at.
  std::vector<std::uint8_t> active;  ///< One for each control point.
  double tie_sigma_px = 1;           ///< Of a tie, in its own pixels.
  double bending_m = 1;
};

/// A tie among the control points: the first of the 4 × 4 it depends on, and their weights row by row.
struct TieFootprint {
  int column = 0;
  int row = 0;
  Eigen::Matrix<double, 16, 1> weights;
};

TieFootprint footprint_of(const WarpField& grid, const Eigen::Vector2d& point_m);

/// The inverse variance of a tie, 1/m²: w/σ² of fit_warp.h.
double tie_precision(const Tie& tie, double tie_sigma_px);

/// The control displacements that minimise the sum over ties[i] with use[i] != 0, from `start` on: once for each of
/// `loss_scales` (of Cauchy's loss, in standard deviations), the last one counts. Ceres, sparse Cholesky, one thread.
std::vector<Eigen::Vector2d> solve_warp(const WarpProblem& problem, std::span<const Tie> ties,
                                        const std::vector<std::uint8_t>& use, std::vector<Eigen::Vector2d> start,
                                        std::span<const double> loss_scales);

/// Half the matrix of second derivatives of the sum for one axis, ties weighted as Cauchy's loss of scale
/// `loss_scale` weights them at the field's residuals; the row of a control point is its place in the grid.
Eigen::SparseMatrix<double> warp_curvature(const WarpProblem& problem, std::span<const Tie> ties,
                                           const WarpField& field, double loss_scale);

}  // namespace pilotage
