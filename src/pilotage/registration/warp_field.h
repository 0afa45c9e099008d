#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#pragma GCC visibility push(default)

namespace pilotage {

/// A smooth field of displacements: the ground that the reference shows at a point p, the second date shows at p +
/// displacement_m(p). Both in the CRS of the mission grid, metres.
///
/// Uniform cubic B-splines over a grid of control points (T. W. Sederberg, S. R. Parry, "Free-form deformation of solid
/// geometric models", SIGGRAPH 1986; D. Rueckert et al., IEEE Trans. Medical Imaging 18(8), 1999): twice continuously
/// differentiable, and each value depends on 4 × 4 control points only.
struct WarpField {
  double min_x_m = 0;  ///< Of control point (0, 0); the field is defined from one spacing further on.
  double min_y_m = 0;
  double spacing_m = 1;
  int columns = 0;                         ///< Control points to the east.
  int rows = 0;                            ///< To the north.
  std::vector<Eigen::Vector2d> control_m;  ///< Row by row, columns · rows.
  std::vector<double> node_sigma_m;  ///< σ of the displacement at each control point, per axis; NaN = nothing known.

  /// Where ties are: squares of side cell_m from (min_x_m, min_y_m), cell_columns · cell_rows, row by row; 1 = known.
  double cell_m = 1;
  int cell_columns = 0;
  int cell_rows = 0;
  std::vector<std::uint8_t> cell_known;

  /// Whether ties are near enough. Everything outside the grid is not known.
  bool known(double x_m, double y_m) const;
  /// (NaN, NaN) where the field is not known.
  Eigen::Vector2d displacement_m(double x_m, double y_m) const;
  /// Predicted standard deviation of the displacement per axis; NaN where the field is not known.
  double sigma_m(double x_m, double y_m) const;
  /// The smooth continuation of the field to any place; (0, 0) when there are no control points. Finite always.
  Eigen::Vector2d continued_m(double x_m, double y_m) const;
};

/// The four weights of a uniform cubic B-spline at `t` in [0, 1] of a span; they sum to 1.
Eigen::Vector4d bspline_weights(double t);

}  // namespace pilotage

#pragma GCC visibility pop
