#include "locate_rings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>

#include "ring_scene.h"
#include <Eigen/Dense>
#include <ceres/ceres.h>

#include "pilotage/base/angle.h"
#include "pilotage/base/error.h"
#include "pilotage/base/statistics.h"

namespace pilotage {
namespace {

constexpr int kPoints = 12;       // of a circle that are compared
constexpr double kFreedoms = 5;   // of an ellipse: what so many points are worth
constexpr double kLossScale = 3;  // root of the sum of a sight's squared residuals, from which on it counts less
constexpr int kFewestViews = 3;
constexpr double kNarrowest_deg = 20;
constexpr double kMostLean_deg = 15;
constexpr double kMostMisfit = 4;
/// Of its kind's inner radius, for the circle in the middle of the tube: a point on the rim is on all the ellipses too.
constexpr double kLeastRadius = 0.5;
constexpr double kMostRadius = 2;
constexpr double kMostRadiusError = 0.15;
/// How far the border of a ring's color may lie from its rim: pixels that show ground and ring are of either.
constexpr double kRimSigma_px = 0.3;
/// Of a sight's range by its size, beside the pixels': the rim's thickness, lean and perspective.
constexpr double kRangeError = 0.04;
constexpr double kGateProbability = 0.999;

/// Azimuth and lean of the normals that a triangulation begins with.
constexpr std::array<std::pair<int, int>, 7> kStarts_deg = {
    {{0, 0}, {30, 0}, {60, 0}, {90, 0}, {120, 0}, {150, 0}, {0, 85}}};

using Pose = Eigen::Matrix<double, 6, 1>;
/// Center, azimuth and lean (rad), radius of the circle in the middle of the tube.
using RingState = Eigen::Matrix<double, 6, 1>;

struct SightCost {
  const RingSight& sight;
  const Camera& camera;

  template <class T>
  bool operator()(const T* ring, const T* error, T* residuals) const {
    using Vector = Eigen::Matrix<T, 3, 1>;
    const T ca = ceres::cos(ring[3]);
    const T sa = ceres::sin(ring[3]);
    const T cl = ceres::cos(ring[4]);
    const T sl = ceres::sin(ring[4]);
    const Vector level(ca, -sa, T(0));
    const Vector rising(-sl * sa, -sl * ca, cl);
    const Vector turn(error[3], error[4], error[5]);
    const double scale = std::sqrt(kFreedoms / kPoints) / sight.seen.sigma_px;
    const double c = std::cos(sight.seen.angle_rad);
    const double s = std::sin(sight.seen.angle_rad);
    for (int i = 0; i < kPoints; ++i) {
      const double around = 2 * std::numbers::pi * i / kPoints;
      const Vector on =
          Vector(ring[0], ring[1], ring[2]) + ring[5] * (T(std::cos(around)) * level + T(std::sin(around)) * rising);
      const Vector from(on[0] - (sight.pose.position_m[0] - error[0]), on[1] - (sight.pose.position_m[1] - error[1]),
                        on[2] - (sight.pose.position_m[2] - error[2]));
      const Vector believed = from + turn.cross(from);
      const Vector at = sight.pose.enu_from_camera.transpose().template cast<T>() * believed;
      if (!(at[2] > T(0.1))) return false;
      const T x = camera.fx_px * at[0] / at[2] + camera.cx_px - sight.seen.center_px.x();
      const T y = camera.fy_px * at[1] / at[2] + camera.cy_px - sight.seen.center_px.y();
      const T along = (c * x + s * y) / sight.seen.major_px;
      const T across = (c * y - s * x) / sight.seen.minor_px;
      const T slope = ceres::sqrt(along * along / (sight.seen.major_px * sight.seen.major_px) +
                                  across * across / (sight.seen.minor_px * sight.seen.minor_px) + 1e-12);
      residuals[i] = scale * (along * along + across * across - 1.0) / (2.0 * slope);
    }
    return true;
  }
};

struct PoseCost {
  Eigen::Matrix<double, 6, 6> whiten;  ///< Inverse of the lower root of the covariance.

  template <class T>
  bool operator()(const T* error, T* residuals) const {
    const Eigen::Map<const Eigen::Matrix<T, 6, 1>> given(error);
    Eigen::Map<Eigen::Matrix<T, 6, 1>> white(residuals);
    white = whiten.cast<T>() * given;
    return true;
  }
};

PoseCost pose_cost(const Eigen::Matrix<double, 6, 6>& covariance) {
  const Eigen::LLT<Eigen::Matrix<double, 6, 6>> root(covariance);
  if (root.info() != Eigen::Success) throw UsageError("the covariance of a camera's pose is not positive");
  return {root.matrixL().solve(Eigen::Matrix<double, 6, 6>::Identity())};
}

/// Rough: from a start that may be far off, with a loss that still pulls there.
enum class Stage { kRough, kFine };

struct Solution {
  RingState ring = RingState::Zero();
  std::vector<Pose> errors;
  double cost = 0;
};

Solution solve_from(const std::vector<RingSight>& sights, const Camera& camera, const RingState& start, Stage stage) {
  Solution solution;
  solution.ring = start;
  solution.errors.assign(sights.size(), Pose::Zero());
  ceres::Problem problem;
  const bool fine = stage == Stage::kFine;
  for (std::size_t i = 0; i < sights.size(); ++i) {
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<SightCost, kPoints, 6, 6>(new SightCost{sights[i], camera}),
        fine ? static_cast<ceres::LossFunction*>(new ceres::CauchyLoss(kLossScale)) : new ceres::HuberLoss(kLossScale),
        solution.ring.data(), solution.errors[i].data());
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<PoseCost, 6, 6>(new PoseCost(pose_cost(sights[i].pose_covariance))), nullptr,
        solution.errors[i].data());
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (Pose& error : solution.errors) ordering->AddElementToGroup(error.data(), 0);
  ordering->AddElementToGroup(solution.ring.data(), 1);
  const RingClass& kind = kRingClasses[static_cast<std::size_t>(sights.front().seen.ring_class)];
  problem.SetParameterLowerBound(solution.ring.data(), 5, kLeastRadius * kind.inner_radius_m);
  problem.SetParameterUpperBound(solution.ring.data(), 5, kMostRadius * kind.inner_radius_m);
  options.linear_solver_ordering = ordering;
  options.max_num_iterations = 60;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  solution.cost = summary.IsSolutionUsable() ? summary.final_cost : 1e30;
  return solution;
}

/// Of the ring's state, the errors of the poses eliminated; nothing where it is not determined. Linear in the
/// residuals, each sight with the weight that its loss gives it.
std::optional<Eigen::Matrix<double, 6, 6>> covariance_of(const std::vector<RingSight>& sights, const Camera& camera,
                                                         const Solution& solution) {
  using Jacobian = Eigen::Matrix<double, kPoints, 6, Eigen::RowMajor>;
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();
  for (std::size_t i = 0; i < sights.size(); ++i) {
    const ceres::AutoDiffCostFunction<SightCost, kPoints, 6, 6> cost(new SightCost{sights[i], camera});
    const std::array<const double*, 2> parameters = {solution.ring.data(), solution.errors[i].data()};
    Eigen::Matrix<double, kPoints, 1> residuals;
    Jacobian of_ring;
    Jacobian of_pose;
    std::array<double*, 2> jacobians = {of_ring.data(), of_pose.data()};
    if (!cost.Evaluate(parameters.data(), residuals.data(), jacobians.data())) continue;
    const double weight = 1 / (1 + residuals.squaredNorm() / (kLossScale * kLossScale));
    const PoseCost pose = pose_cost(sights[i].pose_covariance);
    const Eigen::Matrix<double, 6, 6> both = weight * of_ring.transpose() * of_pose;
    const Eigen::Matrix<double, 6, 6> own =
        weight * of_pose.transpose() * of_pose + pose.whiten.transpose() * pose.whiten;
    information += weight * of_ring.transpose() * of_ring - both * own.ldlt().solve(both.transpose());
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> axes(information);
  if (!(axes.eigenvalues().minCoeff() > 1e-9 * axes.eigenvalues().maxCoeff())) return std::nullopt;
  return information.inverse();
}

/// Mean squared residual of a sight, its pose's error included.
double misfit_of(const RingSight& sight, const Camera& camera, const Solution& solution, std::size_t index) {
  std::array<double, kPoints> residuals{};
  if (!SightCost{sight, camera}(solution.ring.data(), solution.errors[index].data(), residuals.data())) return 1e30;
  double sum = 0;
  for (const double residual : residuals) sum += residual * residual;
  const Pose white = pose_cost(sight.pose_covariance).whiten * solution.errors[index];
  return (sum + white.squaredNorm()) / kFreedoms;
}

Eigen::Vector3d line_of_sight(const RingSight& sight, const Camera& camera) {
  const Eigen::Vector2d at = sight.seen.center_px - Eigen::Vector2d(camera.cx_px, camera.cy_px);
  return sight.pose.enu_from_camera * Eigen::Vector3d(at.x() / camera.fx_px, at.y() / camera.fy_px, 1);
}

double spread_deg(const std::vector<RingSight>& sights, const Camera& camera) {
  double least = 1;
  for (std::size_t i = 0; i < sights.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      least = std::min(
          least, line_of_sight(sights[i], camera).normalized().dot(line_of_sight(sights[j], camera).normalized()));
    }
  }
  return std::acos(std::clamp(least, -1.0, 1.0)) / kRadPerDeg;
}

/// Where a sight's ring is when it has the size of its kind, and how sure that is.
struct PlaceBySize {
  Eigen::Vector3d center_m;
  Eigen::Matrix3d covariance_m2;
};

PlaceBySize place_by_size(const RingSight& sight, const Camera& camera) {
  const RingClass& kind = kRingClasses[static_cast<std::size_t>(sight.seen.ring_class)];
  const Eigen::Vector3d line = line_of_sight(sight, camera);
  const double depth_m = camera.fx_px * (kind.inner_radius_m + kind.tube_radius_m) / sight.seen.major_px;
  const double range_sigma_m = depth_m * std::hypot(2 * sight.seen.sigma_px / sight.seen.major_px, kRangeError);
  const Eigen::Vector3d out = depth_m * line;
  Eigen::Matrix3d cross;
  cross << 0, -out.z(), out.y(), out.z(), 0, -out.x(), -out.y(), out.x(), 0;
  const double pixel_m = depth_m * sight.seen.sigma_px / camera.fx_px;
  const auto turn = sight.pose_covariance.bottomRightCorner<3, 3>();
  return {sight.pose.position_m + out, sight.pose_covariance.topLeftCorner<3, 3>() + cross * turn * cross.transpose() +
                                           range_sigma_m * range_sigma_m * line * line.transpose() +
                                           pixel_m * pixel_m * Eigen::Matrix3d::Identity()};
}

/// The point nearest to all lines of sight; `otherwise` when they are next to parallel.
Eigen::Vector3d meeting_point(const std::vector<RingSight>& sights, const Camera& camera,
                              const Eigen::Vector3d& otherwise) {
  Eigen::Matrix3d across = Eigen::Matrix3d::Zero();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const RingSight& sight : sights) {
    const Eigen::Vector3d line = line_of_sight(sight, camera).normalized();
    const Eigen::Matrix3d projector = Eigen::Matrix3d::Identity() - line * line.transpose();
    across += projector;
    sum += projector * sight.pose.position_m;
  }
  const double least = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(across).eigenvalues().minCoeff();
  return least > 0.03 * static_cast<double>(sights.size()) ? Eigen::Vector3d(across.ldlt().solve(sum)) : otherwise;
}

struct Group {
  std::vector<RingSight> sights;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d weighted = Eigen::Vector3d::Zero();

  Eigen::Vector3d center_m() const { return information.ldlt().solve(weighted); }
  void add(const RingSight& sight, const PlaceBySize& place) {
    const Eigen::Matrix3d inverse = place.covariance_m2.inverse();
    sights.push_back(sight);
    information += inverse;
    weighted += inverse * place.center_m;
  }
};

double distance_squared(const Eigen::Vector3d& apart_m, const Eigen::Matrix3d& covariance_m2) {
  return apart_m.dot(covariance_m2.ldlt().solve(apart_m));
}

std::vector<Group> group_by_place(const std::vector<RingSight>& sights, const Camera& camera, double gate) {
  std::vector<Group> groups;
  for (const RingSight& sight : sights) {
    const PlaceBySize place = place_by_size(sight, camera);
    Group* nearest = nullptr;
    double least = gate;
    for (Group& group : groups) {
      if (group.sights.front().seen.ring_class != sight.seen.ring_class) continue;
      const double distance =
          distance_squared(group.center_m() - place.center_m, place.covariance_m2 + group.information.inverse());
      if (distance < least) {
        least = distance;
        nearest = &group;
      }
    }
    if (nearest == nullptr) nearest = &groups.emplace_back();
    nearest->add(sight, place);
  }
  return groups;
}

RefusedRing why_refused(const LocatedRing& ring) {
  const RingClass& kind = kRingClasses[static_cast<std::size_t>(ring.ring_class)];
  if (ring.views < kFewestViews) return RefusedRing::kFewViews;
  if (ring.spread_deg < kNarrowest_deg) return RefusedRing::kNarrow;
  if (ring.misfit > kMostMisfit) return RefusedRing::kMisfit;
  if (std::abs(ring.lean_deg) > kMostLean_deg) return RefusedRing::kLying;
  if (std::abs(ring.inner_radius_m / kind.inner_radius_m - 1) > kMostRadiusError) return RefusedRing::kRadius;
  return RefusedRing::kNone;
}

/// Two rings of one kind that are one by their places; two that stand are a diameter apart.
std::optional<std::pair<std::size_t, std::size_t>> two_at_one_place(const std::vector<LocatedRing>& rings,
                                                                    double gate) {
  for (std::size_t i = 0; i < rings.size(); ++i) {
    for (std::size_t j = i + 1; j < rings.size(); ++j) {
      if (rings[i].ring_class != rings[j].ring_class) continue;
      const Eigen::Vector3d apart_m = rings[i].center_m - rings[j].center_m;
      const double diameter_m = 2 * kRingClasses[static_cast<std::size_t>(rings[i].ring_class)].inner_radius_m;
      if (rings[i].views == 0 || rings[j].views == 0 || apart_m.norm() > diameter_m) continue;
      if (distance_squared(apart_m, rings[i].covariance_m2 + rings[j].covariance_m2) < gate) return std::pair{i, j};
    }
  }
  return std::nullopt;
}

}  // namespace

std::string_view refused_ring_name(RefusedRing why) {
  switch (why) {
    case RefusedRing::kNone:
      return "none";
    case RefusedRing::kFewViews:
      return "few_views";
    case RefusedRing::kNarrow:
      return "narrow";
    case RefusedRing::kLying:
      return "lying";
    case RefusedRing::kMisfit:
      return "misfit";
    case RefusedRing::kRadius:
      return "radius";
  }
  return "";
}

LocatedRing triangulate_ring(const std::vector<RingSight>& sights, const Camera& camera,
                             const Eigen::Vector3d& start_m) {
  if (sights.empty()) throw UsageError("a ring is triangulated from one sight or more");
  const RingClass& kind = kRingClasses[static_cast<std::size_t>(sights.front().seen.ring_class)];
  const Eigen::Vector3d meeting_m = meeting_point(sights, camera, start_m);
  Solution best;
  best.cost = 1e31;
  // Which way a ring faces one sight leaves open in two ways, and descent may end in the wrong one.
  for (const auto& [azimuth_deg, lean_deg] : kStarts_deg) {
    RingState start;
    start << meeting_m, azimuth_deg * kRadPerDeg, lean_deg * kRadPerDeg, kind.inner_radius_m + kind.tube_radius_m;
    const Solution rough = solve_from(sights, camera, start, Stage::kRough);
    const Solution solution = solve_from(sights, camera, rough.ring, Stage::kFine);
    if (solution.cost < best.cost) best = solution;
  }
  best = solve_from(sights, camera, best.ring, Stage::kFine);
  const auto covariance = covariance_of(sights, camera, best);

  LocatedRing ring;
  ring.ring_class = sights.front().seen.ring_class;
  ring.center_m = best.ring.head<3>();
  if (!covariance || best.cost >= 1e30) return ring;
  Eigen::Matrix3d common = Eigen::Matrix3d::Zero();
  double share = 0;
  double pixel_m = 0;
  double misfit = 0;
  std::vector<RingSight> agreeing;
  for (std::size_t i = 0; i < sights.size(); ++i) {
    common += sights[i].pose_covariance.topLeftCorner<3, 3>() / static_cast<double>(sights.size());
    const double off = misfit_of(sights[i], camera, best, i);
    if (off > 3 * kMostMisfit) continue;
    agreeing.push_back(sights[i]);
    misfit += off;
    share += sights[i].seen.inner_share;
    pixel_m += best.ring[5] / sights[i].seen.major_px;
  }
  ring.covariance_m2 = covariance->topLeftCorner<3, 3>() + common;
  // The same plane has two normals, and two pairs of angles for each.
  const Eigen::Vector3d normal = direction(best.ring[3] / kRadPerDeg, best.ring[4] / kRadPerDeg);
  const double azimuth_deg = std::atan2(normal.x(), normal.y()) / kRadPerDeg;
  ring.lean_deg = std::asin(std::clamp(normal.z(), -1.0, 1.0)) / kRadPerDeg;
  if (azimuth_deg < 0) ring.lean_deg = -ring.lean_deg;
  ring.azimuth_deg = azimuth_deg < 0 ? azimuth_deg + 180 : azimuth_deg;
  ring.azimuth_sigma_deg = std::sqrt(std::max(0.0, (*covariance)(3, 3))) / kRadPerDeg;
  ring.views = static_cast<int>(agreeing.size());
  if (ring.views == 0) return ring;
  ring.misfit = misfit / ring.views;
  ring.spread_deg = spread_deg(agreeing, camera);
  // Rims at R − a and R + a: (R − a) / (R + a) is the share.
  share /= ring.views;
  ring.inner_radius_m = best.ring[5] * 2 * share / (1 + share);
  ring.inner_radius_sigma_m =
      std::hypot(std::sqrt(std::max(0.0, (*covariance)(5, 5))), kRimSigma_px * pixel_m / ring.views);
  return ring;
}

RingArray locate_rings(const std::vector<RingSight>& sights, const Camera& camera) {
  const double gate = chi_squared_quantile(kGateProbability, 3);
  std::vector<std::vector<RingSight>> groups;
  std::vector<LocatedRing> rings;
  for (const Group& group : group_by_place(sights, camera, gate)) {
    groups.push_back(group.sights);
    if (group.sights.size() >= 2) {
      rings.push_back(triangulate_ring(group.sights, camera, group.center_m()));
    } else {
      rings.push_back({.ring_class = group.sights.front().seen.ring_class, .center_m = group.center_m()});
    }
  }
  while (const auto pair = two_at_one_place(rings, gate)) {
    const auto [kept, joined] = *pair;
    groups[kept].insert(groups[kept].end(), groups[joined].begin(), groups[joined].end());
    rings[kept] = triangulate_ring(groups[kept], camera, rings[kept].center_m);
    groups.erase(groups.begin() + static_cast<std::ptrdiff_t>(joined));
    rings.erase(rings.begin() + static_cast<std::ptrdiff_t>(joined));
  }
  RingArray array;
  for (const LocatedRing& ring : rings) {
    const RefusedRing why = why_refused(ring);
    if (why == RefusedRing::kNone) {
      array.rings.push_back(ring);
    } else {
      array.refused.push_back({ring, why});
    }
  }
  return array;
}

}  // namespace pilotage
