#pragma once

#include <optional>
#include <vector>

#include "locate_rings.h"
#include "ring_scene.h"
#include <Eigen/Core>

namespace pilotage {

/// The line through rings: points 0.1 m apart.
using CourseLine = std::vector<Eigen::Vector3d>;

/// The array in the order in which it is flown (bearing_deg), with the normal's sense that leads clockwise around the
/// field.
std::vector<LocatedRing> in_order(std::vector<LocatedRing> rings);

/// From a place with a direction of flight through the rings: straight for 2.5 m before and behind each, cubic Hermite
/// curves between, and 4 m beyond the last.
CourseLine line_through(const std::vector<LocatedRing>& rings, const Eigen::Vector3d& from_m,
                        const Eigen::Vector3d& flying);

/// A carrot follower: flies to the point of the line that is `ahead_m` beyond the nearest one.
class Follower {
 public:
  Follower(CourseLine line, double speed_mps, double ahead_m)
      : line_(std::move(line)), speed_mps_(speed_mps), ahead_m_(ahead_m) {}

  /// The velocity to fly with from a place.
  Eigen::Vector3d velocity_mps(const Eigen::Vector3d& at_m);
  bool arrived() const { return nearest_ + 2 >= line_.size(); }

 private:
  CourseLine line_;
  double speed_mps_;
  double ahead_m_;
  std::size_t nearest_ = 0;
};

/// A place of a flown path: the truth, and what the navigation knew.
struct PathPoint {
  double time_s = 0;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d believed_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Zero();
};

/// How a flight met a true ring.
struct Crossing {
  /// Of the pass through the ring's plane, in the right direction and nearest to the axis; nothing without one within
  /// 10 m.
  std::optional<double> offset_m;
  double time_s = 0;
  double angle_deg = 0;      ///< Between path and axis.
  double clearance_m = 0;    ///< Inner radius − half span − offset.
  bool pierced = false;      ///< Offset below the inner radius.
  bool collided = false;     ///< With the ring or its post.
  bool backwards = false;    ///< Pierced in the wrong direction at some time.
  std::size_t at_point = 0;  ///< Index of the path's point behind the plane.

  bool crossed() const { return pierced && !collided; }
};

struct CourseOutcome {
  std::vector<Crossing> crossings;  ///< As RingScene::rings.
  int crossed = 0;
  bool in_order = false;  ///< Every ring is crossed, in the order of the course, none backwards.
  int collisions = 0;     ///< Rings, posts and decoys that were touched.
  double time_s = 0;
};

/// Judges a path against the truth.
CourseOutcome judge(const RingScene& scene, const std::vector<PathPoint>& path, double half_span_m);

}  // namespace pilotage
