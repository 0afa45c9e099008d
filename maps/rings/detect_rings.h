#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace pilotage {

/// A ring in a picture.
struct SeenRing {
  int ring_class = 0;  ///< Index of kRingClasses, by color.
  /// The ellipse of the circle in the middle of the tube: center in pixels (centers at +0.5), half axes, the longer
  /// first, and the direction of the longer from x towards y.
  Eigen::Vector2d center_px{0, 0};
  double major_px = 0;
  double minor_px = 0;
  double angle_rad = 0;
  double inner_share = 0;  ///< Longer half axis of the inner rim over that of the outer one.
  double sigma_px = 0;     ///< Of a point of the ellipse, by how well the rims fit.
};

/// What a picture's contours came to.
struct DetectionCounts {
  int patches = 0;  ///< Of a ring's color and large enough.
  int no_hole = 0;
  int cut = 0;       ///< By the picture's edge.
  int too_thin = 0;  ///< Seen too far from the side or from too far away.
  int no_ellipse = 0;
  int rings = 0;
};

/// Finds rings in `rgb` (CV_8UC3) by its pixels alone: patches of the colors of kRingClasses (hue, with saturation)
/// with one large hole whose outer and inner rims are ellipses (A. Fitzgibbon, M. Pilu, R. Fisher, "Direct least square
/// fitting of ellipses", PAMI 21, 1999) about one center. The silhouette of a torus lies half its thickness to both
/// sides of the projected circle in the middle of its tube, so that circle's ellipse is the mean of both. A ring that
/// something hides in part has no whole rim and is not reported.
std::vector<SeenRing> detect_rings(const cv::Mat& rgb, DetectionCounts* counts = nullptr);

}  // namespace pilotage
