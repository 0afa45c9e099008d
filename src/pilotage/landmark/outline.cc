#include "pilotage/landmark/outline.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

using Eigen::Vector2d;
using Outline = std::vector<Vector2d>;

constexpr int kCircleCorners = 32;

double cross(const Vector2d& a, const Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
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
  const Vector2d& origin = outline.front();  // coordinates of a CRS are large, and OpenCV's are of 32 bits
  std::vector<cv::Point2f> points;
  for (const Vector2d& point : outline)
    points.emplace_back(cv::Point2d(point.x() - origin.x(), point.y() - origin.y()));
  const cv::RotatedRect rectangle = cv::minAreaRect(points);
  OrientedBox box;
  box.center = origin + Vector2d(rectangle.center.x, rectangle.center.y);
  box.length = std::max(rectangle.size.width, rectangle.size.height);
  box.width = std::min(rectangle.size.width, rectangle.size.height);
  const double turned_deg = rectangle.angle + (rectangle.size.width >= rectangle.size.height ? 0 : 90);
  const double angle = std::remainder(turned_deg * std::numbers::pi / 180, std::numbers::pi);
  box.angle_rad = angle < 0 ? angle + std::numbers::pi : angle;
  if (box.angle_rad >= std::numbers::pi) box.angle_rad = 0;
  return box;
}

double overlap(const OrientedBox& a, const OrientedBox& b) {
  const auto rectangle = [&](const OrientedBox& box) {
    const Vector2d middle = box.center - a.center;
    return cv::RotatedRect(cv::Point2f(cv::Point2d(middle.x(), middle.y())),
                           cv::Size2f(cv::Size2d(box.length, box.width)),
                           static_cast<float>(box.angle_rad * 180 / std::numbers::pi));
  };
  std::vector<cv::Point2f> both;
  if (cv::rotatedRectangleIntersection(rectangle(a), rectangle(b), both) == cv::INTERSECT_NONE || both.size() < 3) {
    return 0;
  }
  std::vector<cv::Point2f> hull;
  cv::convexHull(both, hull);
  const double common = cv::contourArea(hull);
  return common / (a.length * a.width + b.length * b.width - common);
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
