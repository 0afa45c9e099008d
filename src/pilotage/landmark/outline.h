#pragma once

#include <vector>

#include <Eigen/Core>

namespace pilotage {

/// Area within a closed outline, whichever way it runs, in squares of the outline's unit. 0 for fewer than three
/// corners.
double outline_area(const std::vector<Eigen::Vector2d>& outline);

/// 4π · area / perimeter²: 1 for a circle, 0.785 for a square, less for anything longer. 0 for an outline without
/// extent.
double circularity(const std::vector<Eigen::Vector2d>& outline);

/// The smallest rectangle around an outline.
struct OrientedBox {
  Eigen::Vector2d center{0, 0};
  double length = 0;  ///< Along its longer side.
  double width = 0;
  /// Of the longer side, against the clock from the x axis of the outline's plane, radians in [0, π).
  double angle_rad = 0;
};

/// Rotating calipers over the convex hull (G. Toussaint, "Solving geometric problems with the rotating calipers",
/// 1983). Throws UsageError for an empty outline.
OrientedBox oriented_box(const std::vector<Eigen::Vector2d>& outline);

/// Share of the area of two oriented boxes' axis-parallel bounds that both cover, of what either covers.
double bounds_overlap(const std::vector<Eigen::Vector2d>& a, const std::vector<Eigen::Vector2d>& b);

/// A regular polygon in place of a circle.
std::vector<Eigen::Vector2d> circle_outline(const Eigen::Vector2d& center, double diameter);

}  // namespace pilotage
