#include "detect_rings.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <opencv2/imgproc.hpp>

#include "pilotage/base/angle.h"
#include "pilotage/base/error.h"

namespace pilotage {
namespace {

using Contour = std::vector<cv::Point>;

constexpr int kLeastSaturation = 130;
constexpr int kLeastValue = 50;
constexpr double kLeastMajor_px = 7;
constexpr double kLeastInnerMinor_px = 2.5;
constexpr std::size_t kLeastPoints = 12;
/// Root mean square distance of a rim from its ellipse: of pixels, and of a share of its size.
constexpr double kMostOff_px = 0.45;
constexpr double kMostOff = 0.02;
constexpr double kMostApart = 0.12;  ///< Centers of the rims, as a share of the longer half axis.
/// Of a point of a rim, whose pixels are 0 or 1, however well they fit; rims of one ring err together.
constexpr double kLeastSigma_px = 0.25;

struct Ellipse {
  Eigen::Vector2d center_px;
  double major_px;
  double minor_px;
  double angle_rad;
  double off_px;  ///< Root mean square distance of the contour from it.
};

/// Hue of OpenCV, 0 … 179. Index as kRingClasses.
cv::Mat pixels_of_class(const cv::Mat& hsv, int ring_class) {
  cv::Mat mask;
  const auto between = [&](int low, int high) {
    cv::Mat part;
    cv::inRange(hsv, cv::Scalar(low, kLeastSaturation, kLeastValue), cv::Scalar(high, 255, 255), part);
    return part;
  };
  if (ring_class == 0) {
    cv::bitwise_or(between(0, 9), between(171, 179), mask);
  } else {
    mask = between(102, 125);
  }
  return mask;
}

std::optional<Ellipse> fit_ellipse(const Contour& contour) {
  if (contour.size() < kLeastPoints) return std::nullopt;
  const cv::RotatedRect box = cv::fitEllipseDirect(contour);
  const bool wide = box.size.width >= box.size.height;
  Ellipse fit{{box.center.x + 0.5, box.center.y + 0.5},
              0.5 * std::max(box.size.width, box.size.height),
              0.5 * std::min(box.size.width, box.size.height),
              (box.angle + (wide ? 0 : 90)) * kRadPerDeg,
              0};
  if (!(fit.minor_px > 0) || !std::isfinite(fit.major_px)) return std::nullopt;
  double sum = 0;
  const double c = std::cos(fit.angle_rad);
  const double s = std::sin(fit.angle_rad);
  for (const cv::Point& point : contour) {
    const Eigen::Vector2d d = Eigen::Vector2d(point.x + 0.5, point.y + 0.5) - fit.center_px;
    const Eigen::Vector2d at(c * d.x() + s * d.y(), c * d.y() - s * d.x());
    const Eigen::Vector2d slope(at.x() / (fit.major_px * fit.major_px), at.y() / (fit.minor_px * fit.minor_px));
    const double off = (slope.dot(at) - 1) / (2 * std::max(slope.norm(), 1e-9));
    sum += off * off;
  }
  fit.off_px = std::sqrt(sum / static_cast<double>(contour.size()));
  return fit;
}

bool touches_edge(const Contour& contour, const cv::Size& size) {
  const cv::Rect box = cv::boundingRect(contour);
  return box.x <= 1 || box.y <= 1 || box.x + box.width >= size.width - 1 || box.y + box.height >= size.height - 1;
}

bool is_smooth(const Ellipse& rim) {
  return rim.off_px <= kMostOff_px + kMostOff * rim.major_px;
}

/// The ring between two rims. OpenCV's contours run through the outermost pixels of the ring itself, half a pixel
/// within each rim.
SeenRing ring_between(int ring_class, const Ellipse& outer, const Ellipse& inner) {
  SeenRing ring;
  ring.ring_class = ring_class;
  ring.center_px = 0.5 * (outer.center_px + inner.center_px);
  ring.major_px = 0.5 * (outer.major_px + inner.major_px);
  ring.minor_px = 0.5 * (outer.minor_px + inner.minor_px);
  // Directions are the same half a turn on.
  const double x = std::cos(2 * outer.angle_rad) + std::cos(2 * inner.angle_rad);
  const double y = std::sin(2 * outer.angle_rad) + std::sin(2 * inner.angle_rad);
  ring.angle_rad = 0.5 * std::atan2(y, x);
  ring.inner_share = (inner.major_px - 0.5) / (outer.major_px + 0.5);
  ring.sigma_px = std::max(kLeastSigma_px, 0.5 * std::hypot(outer.off_px, inner.off_px));
  return ring;
}

/// The largest hole of a patch; −1 when it has none.
int largest_hole(const std::vector<Contour>& contours, const std::vector<cv::Vec4i>& hierarchy, int first) {
  int largest = -1;
  double most = 0;
  for (int i = first; i >= 0; i = hierarchy[static_cast<std::size_t>(i)][0]) {
    const double area = cv::contourArea(contours[static_cast<std::size_t>(i)]);
    if (area > most) {
      most = area;
      largest = i;
    }
  }
  return largest;
}

std::optional<SeenRing> ring_of(int ring_class, const Contour& outline, const Contour& hole, DetectionCounts& counts) {
  const auto outer = fit_ellipse(outline);
  const auto inner = fit_ellipse(hole);
  if (!outer || !inner || inner->minor_px < kLeastInnerMinor_px || outer->major_px < kLeastMajor_px) {
    ++counts.too_thin;
    return std::nullopt;
  }
  const bool about_one = (outer->center_px - inner->center_px).norm() <= kMostApart * outer->major_px &&
                         inner->major_px < outer->major_px && inner->minor_px < outer->minor_px;
  if (!is_smooth(*outer) || !is_smooth(*inner) || !about_one) {
    ++counts.no_ellipse;
    return std::nullopt;
  }
  ++counts.rings;
  return ring_between(ring_class, *outer, *inner);
}

}  // namespace

std::vector<SeenRing> detect_rings(const cv::Mat& rgb, DetectionCounts* counts) {
  if (rgb.type() != CV_8UC3) throw UsageError("rings are looked for in a picture of 8-bit red, green and blue");
  DetectionCounts own;
  std::vector<SeenRing> rings;
  cv::Mat hsv;
  cv::cvtColor(rgb, hsv, cv::COLOR_RGB2HSV);
  for (int ring_class = 0; ring_class < 2; ++ring_class) {
    std::vector<Contour> contours;
    std::vector<cv::Vec4i> hierarchy;
    cv::findContours(pixels_of_class(hsv, ring_class), contours, hierarchy, cv::RETR_CCOMP, cv::CHAIN_APPROX_NONE);
    for (std::size_t i = 0; i < contours.size(); ++i) {
      if (hierarchy[i][3] >= 0 || contours[i].size() < 2 * kLeastPoints) continue;
      ++own.patches;
      const int hole = largest_hole(contours, hierarchy, hierarchy[i][2]);
      if (hole < 0) {
        ++own.no_hole;
      } else if (touches_edge(contours[i], rgb.size())) {
        ++own.cut;
      } else if (const auto ring = ring_of(ring_class, contours[i], contours[static_cast<std::size_t>(hole)], own)) {
        rings.push_back(*ring);
      }
    }
  }
  if (counts != nullptr) *counts = own;
  return rings;
}

}  // namespace pilotage
