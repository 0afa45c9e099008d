#pragma once

#include <algorithm>
#include <limits>

#include <Eigen/Core>

#pragma GCC visibility push(default)

namespace pilotage {

/// An axis-parallel rectangle in the CRS of the mission grid, metres; empty when min > max.
struct Bounds {
  double min_x_m = std::numeric_limits<double>::infinity();
  double min_y_m = std::numeric_limits<double>::infinity();
  double max_x_m = -std::numeric_limits<double>::infinity();
  double max_y_m = -std::numeric_limits<double>::infinity();

  bool empty() const { return !(min_x_m <= max_x_m && min_y_m <= max_y_m); }
  double width_m() const { return max_x_m - min_x_m; }
  double height_m() const { return max_y_m - min_y_m; }
  Eigen::Vector2d center_m() const { return {(min_x_m + max_x_m) / 2, (min_y_m + max_y_m) / 2}; }

  /// Left and lower edges belong to the rectangle, right and upper edges do not, so that cells share no point.
  bool contains(const Eigen::Vector2d& point_m) const {
    return point_m.x() >= min_x_m && point_m.x() < max_x_m && point_m.y() >= min_y_m && point_m.y() < max_y_m;
  }
  bool intersects(const Bounds& other) const {
    return min_x_m < other.max_x_m && other.min_x_m < max_x_m && min_y_m < other.max_y_m && other.min_y_m < max_y_m;
  }
  void extend(const Eigen::Vector2d& point_m) {
    min_x_m = std::min(min_x_m, point_m.x());
    min_y_m = std::min(min_y_m, point_m.y());
    max_x_m = std::max(max_x_m, point_m.x());
    max_y_m = std::max(max_y_m, point_m.y());
  }
  Bounds grown(double margin_m) const {
    return {min_x_m - margin_m, min_y_m - margin_m, max_x_m + margin_m, max_y_m + margin_m};
  }
};

}  // namespace pilotage

#pragma GCC visibility pop
