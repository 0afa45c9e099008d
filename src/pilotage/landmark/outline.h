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

/// To some 1e-6 of its extent; of a square any of its sides is the longer one. Throws UsageError for an empty outline.
OrientedBox oriented_box(const std::vector<Eigen::Vector2d>& outline);

/// Share of the area that two boxes both cover, of what either covers.
double overlap(const OrientedBox& a, const OrientedBox& b);

/// A regular polygon in place of a circle.
std::vector<Eigen::Vector2d> circle_outline(const Eigen::Vector2d& center, double diameter);

}  // namespace pilotage
