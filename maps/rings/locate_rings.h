#pragma once

#include <string_view>
#include <vector>

#include "detect_rings.h"
#include "rasterise.h"
#include <Eigen/Core>

#include "pilotage/camera/camera.h"

namespace pilotage {

/// A ring seen from where the navigation believed the camera to be.
struct RingSight {
  SeenRing seen;
  CameraPose pose;
  /// Of the pose's errors: position east, north, up (m), and the turn about east, north, up (rad) that leads from the
  /// true directions to the believed ones.
  Eigen::Matrix<double, 6, 6> pose_covariance = Eigen::Matrix<double, 6, 6>::Zero();
};

/// An element of the array of obstacles: a ring by its sights. The normal's sense is open.
struct LocatedRing {
  int ring_class = 0;
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Zero();
  double azimuth_deg = 0;  ///< Of the normal: 0 … 180.
  double azimuth_sigma_deg = 0;
  double lean_deg = 0;  ///< Of the normal above the horizon: −90 … 90.
  double inner_radius_m = 0;
  double inner_radius_sigma_m = 0;
  int views = 0;          ///< That agree with it.
  double misfit = 0;      ///< Mean squared residual of those, 1 where their sigmas are right.
  double spread_deg = 0;  ///< Largest angle between two lines of sight.
};

/// Why something that was seen is no element of the array.
enum class RefusedRing { kNone, kFewViews, kNarrow, kLying, kMisfit, kRadius };
std::string_view refused_ring_name(RefusedRing why);

struct RingArray {
  std::vector<LocatedRing> rings;
  struct Refused {
    LocatedRing ring;
    RefusedRing why = RefusedRing::kNone;
  };
  std::vector<Refused> refused;
};

/// Triangulates sights of one ring: center, normal, radius and the errors of the poses within their covariances, by
/// least squares (Ceres, Cauchy loss for each sight): points of the projected circle lie on the seen ellipses. The
/// poses' errors are taken for independent, which those of one flight are not: the mean covariance of their positions,
/// as if it were common to all, is added to that of the center. `start_m` is a guess of the center.
LocatedRing triangulate_ring(const std::vector<RingSight>& sights, const Camera& camera,
                             const Eigen::Vector3d& start_m);

/// The array of what is seen in all the frames of a scan. A sight has a place by its size, for the sizes of
/// kRingClasses are known; sights belong together where those places agree (squared Mahalanobis distance below the 99.9
/// % quantile of χ² with three degrees), each group is triangulated without use of that size, and two rings of one kind
/// that are at one place by their covariances become one. A ring is in the array with three views or more from
/// directions 20° apart or more that fit it, an upright plane, and the radius of its kind to 15 %.
RingArray locate_rings(const std::vector<RingSight>& sights, const Camera& camera);

}  // namespace pilotage
