#include "pilotage/registration/warp_field.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "pilotage/base/nan.h"

namespace pilotage {
namespace {

/// Where a coordinate falls: the first of its four control points, and how far into their span.
struct Span {
  int first;
  double t;
};

/// Beyond the outermost span the field keeps the value of its edge.
Span span_of(double coordinate_m, double min_m, double spacing_m, int count) {
  const double position = std::clamp((coordinate_m - min_m) / spacing_m, 1.0, static_cast<double>(count - 2));
  const int node = std::min(static_cast<int>(position), count - 3);
  return {node - 1, position - node};
}

}  // namespace

Eigen::Vector4d bspline_weights(double t) {
  const double s = 1 - t;
  return {s * s * s / 6, (3 * t * t * t - 6 * t * t + 4) / 6, (3 * s * s * s - 6 * s * s + 4) / 6, t * t * t / 6};
}

bool WarpField::known(double x_m, double y_m) const {
  const double col = std::floor((x_m - min_x_m) / cell_m);
  const double row = std::floor((y_m - min_y_m) / cell_m);
  if (!(col >= 0 && row >= 0 && col < cell_columns && row < cell_rows)) return false;
  return cell_known[static_cast<std::size_t>(row) * static_cast<std::size_t>(cell_columns) +
                    static_cast<std::size_t>(col)] != 0;
}

Eigen::Vector2d WarpField::continued_m(double x_m, double y_m) const {
  if (columns < 4 || rows < 4) return Eigen::Vector2d::Zero();
  const Span x = span_of(x_m, min_x_m, spacing_m, columns);
  const Span y = span_of(y_m, min_y_m, spacing_m, rows);
  const Eigen::Vector4d wx = bspline_weights(x.t);
  const Eigen::Vector4d wy = bspline_weights(y.t);
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (int j = 0; j < 4; ++j) {
    const std::size_t row = static_cast<std::size_t>(y.first + j) * static_cast<std::size_t>(columns);
    for (int i = 0; i < 4; ++i) sum += wx[i] * wy[j] * control_m[row + static_cast<std::size_t>(x.first + i)];
  }
  return sum;
}

Eigen::Vector2d WarpField::displacement_m(double x_m, double y_m) const {
  if (!known(x_m, y_m)) return {kNaN, kNaN};
  return continued_m(x_m, y_m);
}

double WarpField::sigma_m(double x_m, double y_m) const {
  if (!known(x_m, y_m) || columns < 4 || rows < 4) return kNaN;
  const Span x = span_of(x_m, min_x_m, spacing_m, columns);
  const Span y = span_of(y_m, min_y_m, spacing_m, rows);
  const auto at = [&](int i, int j) {
    return node_sigma_m[static_cast<std::size_t>(y.first + 1 + j) * static_cast<std::size_t>(columns) +
                        static_cast<std::size_t>(x.first + 1 + i)];
  };
  const double below = (1 - x.t) * at(0, 0) + x.t * at(1, 0);
  const double above = (1 - x.t) * at(0, 1) + x.t * at(1, 1);
  return (1 - y.t) * below + y.t * above;
}

}  // namespace pilotage
