#include "course.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pilotage/base/angle.h"

namespace pilotage {
namespace {

constexpr double kPointsApart_m = 0.1;
constexpr double kStraight_m = 2.5;
constexpr double kBeyond_m = 4;
constexpr double kFarOff_m = 10;
constexpr double kPost_m = 0.06;

Eigen::Vector3d normal_of(const LocatedRing& ring) {
  return direction(ring.azimuth_deg, ring.lean_deg);
}

void add_straight(CourseLine& line, const Eigen::Vector3d& to_m) {
  const Eigen::Vector3d from_m = line.back();
  const int points = std::max(1, static_cast<int>(std::ceil((to_m - from_m).norm() / kPointsApart_m)));
  for (int i = 1; i <= points; ++i) line.push_back(from_m + (to_m - from_m) * i / points);
}

/// From the line's end, where it has direction `out`, to a point with direction `in`.
void add_curve(CourseLine& line, const Eigen::Vector3d& out, const Eigen::Vector3d& to_m, const Eigen::Vector3d& in) {
  const Eigen::Vector3d from_m = line.back();
  const double length_m = (to_m - from_m).norm();
  const int points = std::max(2, static_cast<int>(std::ceil(1.2 * length_m / kPointsApart_m)));
  for (int i = 1; i <= points; ++i) {
    const double t = static_cast<double>(i) / points;
    const double u = 1 - t;
    line.push_back((1 + 2 * t) * u * u * from_m + t * u * u * length_m * out + t * t * (3 - 2 * t) * to_m -
                   t * t * u * length_m * in);
  }
}

double distance_to_segment(const Eigen::Vector3d& at, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d along = b - a;
  const double t = along.squaredNorm() > 0 ? std::clamp((at - a).dot(along) / along.squaredNorm(), 0.0, 1.0) : 0;
  return (at - a - t * along).norm();
}

double distance_to_post(const Eigen::Vector3d& at, const Eigen::Vector3d& top) {
  return distance_to_segment(at, {top.x(), top.y(), 0}, top) - kPost_m;
}

double distance_to_ring(const Eigen::Vector3d& at, const Ring& ring) {
  const RingClass& kind = ring.kind();
  const double radius_m = kind.inner_radius_m + kind.tube_radius_m;
  const double along = ring.normal().dot(at - ring.center_m);
  const double aside = (at - ring.center_m - along * ring.normal()).norm();
  const Eigen::Vector3d bottom = ring.center_m - (radius_m + kind.tube_radius_m) * Eigen::Vector3d::UnitZ();
  return std::min(std::hypot(aside - radius_m, along) - kind.tube_radius_m, distance_to_post(at, bottom));
}

/// Discs and frames are taken for solid balls.
double distance_to_decoy(const Eigen::Vector3d& at, const Decoy& decoy) {
  const double radius_m = decoy.kind == DecoyKind::kSquare ? 1.6 * decoy.radius_m : decoy.radius_m;
  if (decoy.kind == DecoyKind::kPainted) return at.z();
  return std::min((at - decoy.center_m).norm() - radius_m, distance_to_post(at, decoy.center_m));
}

Crossing meet(const Ring& ring, const std::vector<PathPoint>& path, double half_span_m) {
  Crossing crossing;
  const Eigen::Vector3d normal = ring.normal();
  for (std::size_t i = 0; i < path.size(); ++i) {
    crossing.collided = crossing.collided || distance_to_ring(path[i].position_m, ring) < half_span_m;
    if (i == 0) continue;
    const Eigen::Vector3d a = path[i - 1].position_m - ring.center_m;
    const Eigen::Vector3d b = path[i].position_m - ring.center_m;
    const double before = normal.dot(a);
    const double behind = normal.dot(b);
    if ((before < 0) == (behind < 0)) continue;
    const double share = before / (before - behind);
    const double offset_m = (a + share * (b - a)).norm();
    if (before >= 0) {
      crossing.backwards = crossing.backwards || offset_m < ring.kind().inner_radius_m;
      continue;
    }
    if (offset_m > crossing.offset_m.value_or(kFarOff_m)) continue;
    crossing.offset_m = offset_m;
    crossing.time_s = path[i - 1].time_s + share * (path[i].time_s - path[i - 1].time_s);
    crossing.angle_deg = std::acos(std::clamp((b - a).normalized().dot(normal), -1.0, 1.0)) / kRadPerDeg;
    crossing.at_point = i;
  }
  if (crossing.offset_m) {
    crossing.pierced = *crossing.offset_m < ring.kind().inner_radius_m;
    crossing.clearance_m = ring.kind().inner_radius_m - half_span_m - *crossing.offset_m;
  }
  return crossing;
}

}  // namespace

std::vector<LocatedRing> in_order(std::vector<LocatedRing> rings) {
  std::sort(rings.begin(), rings.end(), [](const LocatedRing& a, const LocatedRing& b) {
    return bearing_deg(a.center_m) < bearing_deg(b.center_m);
  });
  for (LocatedRing& ring : rings) {
    if (normal_of(ring).dot(direction(bearing_deg(ring.center_m) + 90, 0)) >= 0) continue;
    ring.azimuth_deg += 180;
    ring.lean_deg = -ring.lean_deg;
  }
  return rings;
}

CourseLine line_through(const std::vector<LocatedRing>& rings, const Eigen::Vector3d& from_m,
                        const Eigen::Vector3d& flying) {
  CourseLine line = {from_m};
  Eigen::Vector3d out = flying;
  for (const LocatedRing& ring : rings) {
    const Eigen::Vector3d normal = normal_of(ring);
    add_curve(line, out, ring.center_m - kStraight_m * normal, normal);
    add_straight(line, ring.center_m + kStraight_m * normal);
    out = normal;
  }
  add_straight(line, line.back() + kBeyond_m * out);
  return line;
}

Eigen::Vector3d Follower::velocity_mps(const Eigen::Vector3d& at_m) {
  const auto window = static_cast<std::size_t>(2 * ahead_m_ / kPointsApart_m);
  const std::size_t last = std::min(line_.size() - 1, nearest_ + window);
  for (std::size_t i = nearest_; i <= last; ++i) {
    if ((line_[i] - at_m).norm() < (line_[nearest_] - at_m).norm()) nearest_ = i;
  }
  const auto ahead = static_cast<std::size_t>(ahead_m_ / kPointsApart_m);
  const Eigen::Vector3d to_m = line_[std::min(line_.size() - 1, nearest_ + ahead)] - at_m;
  return to_m.norm() > 1e-6 ? Eigen::Vector3d(speed_mps_ * to_m.normalized()) : Eigen::Vector3d::Zero();
}

CourseOutcome judge(const RingScene& scene, const std::vector<PathPoint>& path, double half_span_m) {
  CourseOutcome outcome;
  double last_s = -std::numeric_limits<double>::infinity();
  outcome.in_order = true;
  for (const Ring& ring : scene.rings) {
    const Crossing crossing = meet(ring, path, half_span_m);
    outcome.crossed += crossing.crossed() ? 1 : 0;
    outcome.collisions += crossing.collided ? 1 : 0;
    outcome.in_order = outcome.in_order && crossing.crossed() && !crossing.backwards && crossing.time_s > last_s;
    last_s = crossing.time_s;
    outcome.crossings.push_back(crossing);
  }
  for (const Decoy& decoy : scene.decoys) {
    const bool touched = std::any_of(path.begin(), path.end(), [&](const PathPoint& point) {
      return distance_to_decoy(point.position_m, decoy) < half_span_m;
    });
    outcome.collisions += touched ? 1 : 0;
  }
  if (!path.empty()) outcome.time_s = path.back().time_s - path.front().time_s;
  return outcome;
}

}  // namespace pilotage
