#include "pilotage/landmark/outline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "pilotage/base/error.h"
#include "pilotage/geo/bounds.h"

namespace pilotage {
namespace {

using Eigen::Vector2d;
using Outline = std::vector<Vector2d>;

constexpr int kCircleCorners = 32;

double cross(const Vector2d& a, const Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Andrew's monotone chain, against the clock, without points on its edges.
Outline convex_hull(Outline points) {
  std::sort(points.begin(), points.end(),
            [](const Vector2d& a, const Vector2d& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  Outline hull;
  for (int side = 0; side < 2; ++side) {
    const std::size_t begin = hull.size();
    for (const Vector2d& point : points) {
      while (hull.size() >= begin + 2 &&
             cross(hull.back() - hull[hull.size() - 2], point - hull[hull.size() - 2]) <= 0) {
        hull.pop_back();
      }
      hull.push_back(point);
    }
    hull.pop_back();  // begins the other side
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

Bounds bounds_of_outline(const Outline& outline) {
  Bounds bounds;
  for (const Vector2d& point : outline) bounds.extend(point);
  return bounds;
}

}  // namespace

double outline_area(const Outline& outline) {
  if (outline.size() < 3) return 0;
  double twice = 0;
  const Vector2d& origin = outline.front();  // coordinates of a CRS are large
  for (std::size_t i = 0; i < outline.size(); ++i) {
    twice += cross(outline[i] - origin, outline[(i + 1) % outline.size()] - origin);
  }
  return std::abs(twice) / 2;
}

double circularity(const Outline& outline) {
  double perimeter = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) perimeter += (outline[(i + 1) % outline.size()] - outline[i]).norm();
  return perimeter > 0 ? 4 * std::numbers::pi * outline_area(outline) / (perimeter * perimeter) : 0;
}

OrientedBox oriented_box(const Outline& outline) {
  if (outline.empty()) throw UsageError("an outline without corners has no box");
  const Vector2d& origin = outline.front();
  Outline moved;
  for (const Vector2d& point : outline) moved.push_back(point - origin);
  const Outline hull = convex_hull(moved);
  OrientedBox best;
  double best_area = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Vector2d edge = hull[(i + 1) % hull.size()] - hull[i];
    if (hull.size() > 1 && edge.norm() == 0) continue;
    const Vector2d along = hull.size() > 1 ? Vector2d(edge.normalized()) : Vector2d(1, 0);
    const Vector2d across(-along.y(), along.x());
    Bounds extent;
    for (const Vector2d& point : hull) extent.extend({along.dot(point), across.dot(point)});
    const double area = extent.width_m() * extent.height_m();
    // Of rectangles as good as equal the first counts: rounding must not choose.
    if (!(area < best_area * (1 - 1e-9)) && best_area != std::numeric_limits<double>::infinity()) continue;
    best_area = area;
    const Vector2d middle = extent.center_m();
    best.center = origin + along * middle.x() + across * middle.y();
    const bool along_is_longer = extent.width_m() >= extent.height_m();
    best.length = std::max(extent.width_m(), extent.height_m());
    best.width = std::min(extent.width_m(), extent.height_m());
    const Vector2d longer = along_is_longer ? along : across;
    double angle = std::atan2(longer.y(), longer.x());
    if (angle < 0) angle += std::numbers::pi;
    best.angle_rad = angle >= std::numbers::pi ? 0 : angle;
  }
  return best;
}

double bounds_overlap(const Outline& a, const Outline& b) {
  const Bounds one = bounds_of_outline(a);
  const Bounds other = bounds_of_outline(b);
  const double width = std::min(one.max_x_m, other.max_x_m) - std::max(one.min_x_m, other.min_x_m);
  const double height = std::min(one.max_y_m, other.max_y_m) - std::max(one.min_y_m, other.min_y_m);
  if (!(width > 0 && height > 0)) return 0;
  const double both = width * height;
  return both / (one.width_m() * one.height_m() + other.width_m() * other.height_m() - both);
}

Outline circle_outline(const Vector2d& center, double diameter) {
  Outline outline;
  for (int i = 0; i < kCircleCorners; ++i) {
    const double angle = 2 * std::numbers::pi * i / kCircleCorners;
    outline.push_back(center + diameter / 2 * Vector2d(std::cos(angle), std::sin(angle)));
  }
  return outline;
}

}  // namespace pilotage
