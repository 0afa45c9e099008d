#include "pilotage/camera/lens.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/LU>

namespace pilotage {
namespace {

/// Polynomial in u = r²: the radial factor is 1 + a[0] u + a[1] u² + …
using RadialCoefficients = std::array<double, 4>;

RadialCoefficients radial_coefficients(const Camera& camera) {
  const auto& d = camera.distortion;
  switch (camera.distortion_model) {
    case DistortionModel::kBrownConrady:
      return {d[0], d[1], d[4], 0};
    case DistortionModel::kFisheye:
      return {d[0], d[1], d[2], d[3]};
    case DistortionModel::kNone:
      break;
  }
  return {};
}

struct RadialValue {
  double value;
  double derivative;  ///< By r.
};

/// r · (1 + Σ a_i r^(2i)) and its derivative.
RadialValue radial(const RadialCoefficients& a, double r) {
  const double u = r * r;
  const double factor = 1 + u * (a[0] + u * (a[1] + u * (a[2] + u * a[3])));
  const double derivative = 1 + u * (3 * a[0] + u * (5 * a[1] + u * (7 * a[2] + u * 9 * a[3])));
  return {r * factor, derivative};
}

double evaluate(const std::vector<double>& coefficients, double x) {
  double value = 0;
  for (auto c = coefficients.rbegin(); c != coefficients.rend(); ++c) value = value * x + *c;
  return value;
}

/// All sign changes of a polynomial (ascending coefficients) in [low, high], ascending: between two neighbouring
/// extrema, which are found the same way, there is at most one.
std::vector<double> sign_changes(const std::vector<double>& coefficients, double low, double high) {
  if (coefficients.size() < 2) return {};
  std::vector<double> derivative;
  for (std::size_t i = 1; i < coefficients.size(); ++i) {
    derivative.push_back(static_cast<double>(i) * coefficients[i]);
  }
  std::vector<double> edges = sign_changes(derivative, low, high);
  edges.insert(edges.begin(), low);
  edges.push_back(high);
  std::vector<double> roots;
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    double a = edges[i];
    double b = edges[i + 1];
    const bool positive_at_a = evaluate(coefficients, a) > 0;
    if (positive_at_a == (evaluate(coefficients, b) > 0)) continue;
    for (int step = 0; step < 200 && a < b; ++step) {
      const double middle = a + (b - a) / 2;
      if (middle <= a || middle >= b) break;
      ((evaluate(coefficients, middle) > 0) == positive_at_a ? a : b) = middle;
    }
    roots.push_back(a);  // the last number before the change
  }
  return roots;
}

/// The radius in [0, max_radius] whose image is `distorted` ≤ max_distorted_radius: Newton inside a shrinking bracket.
double undistorted_radius(const RadialCoefficients& a, double distorted, double max_radius) {
  double low = 0;
  double high = max_radius;
  double r = std::min(distorted, max_radius);
  for (int step = 0; step < 100; ++step) {
    const auto [value, derivative] = radial(a, r);
    (value < distorted ? low : high) = r;
    double next = r - (value - distorted) / derivative;
    if (!(next > low && next < high)) next = low + (high - low) / 2;
    if (std::abs(next - r) <= 1e-16 * (1 + r)) return next;
    r = next;
  }
  return r;
}

Eigen::Vector2d brown_conrady(const Camera& camera, const RadialCoefficients& a, const Eigen::Vector2d& point) {
  const double x = point.x();
  const double y = point.y();
  const double u = x * x + y * y;
  const double factor = 1 + u * (a[0] + u * (a[1] + u * a[2]));
  const double p1 = camera.distortion[2];
  const double p2 = camera.distortion[3];
  return {x * factor + 2 * p1 * x * y + p2 * (u + 2 * x * x), y * factor + p1 * (u + 2 * y * y) + 2 * p2 * x * y};
}

/// Derivatives of brown_conrady.
Eigen::Matrix2d brown_conrady_jacobian(const Camera& camera, const RadialCoefficients& a,
                                       const Eigen::Vector2d& point) {
  const double x = point.x();
  const double y = point.y();
  const double u = x * x + y * y;
  const double factor = 1 + u * (a[0] + u * (a[1] + u * a[2]));
  const double factor_by_u = a[0] + u * (2 * a[1] + u * 3 * a[2]);
  const double p1 = camera.distortion[2];
  const double p2 = camera.distortion[3];
  const double mixed = 2 * x * y * factor_by_u + 2 * p1 * x + 2 * p2 * y;
  Eigen::Matrix2d jacobian;
  jacobian << factor + 2 * x * x * factor_by_u + 2 * p1 * y + 6 * p2 * x, mixed,  //
      mixed, factor + 2 * y * y * factor_by_u + 6 * p1 * y + 2 * p2 * x;
  return jacobian;
}

std::optional<Eigen::Vector2d> undistort_brown_conrady(const Lens& lens, const Eigen::Vector2d& distorted) {
  const RadialCoefficients a = radial_coefficients(lens.camera);
  const double distorted_radius = distorted.norm();
  Eigen::Vector2d point = distorted;
  if (distorted_radius > 0) {
    const double target = std::min(distorted_radius, lens.max_distorted_radius);
    point *= undistorted_radius(a, target, lens.max_radius) / distorted_radius;
  }
  const double tolerance = 1e-7 / std::max(lens.camera.fx_px, lens.camera.fy_px) + 1e-15 * distorted_radius;
  for (int step = 0; step < 30; ++step) {
    const Eigen::Vector2d residual = brown_conrady(lens.camera, a, point) - distorted;
    if (residual.norm() <= tolerance) {
      if (point.norm() > lens.max_radius) return std::nullopt;
      return point;
    }
    const Eigen::Matrix2d jacobian = brown_conrady_jacobian(lens.camera, a, point);
    if (!(jacobian.determinant() > 0)) return std::nullopt;
    point -= jacobian.inverse() * residual;
    if (!point.allFinite()) return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace

Lens make_lens(const Camera& camera) {
  check_camera("camera", camera);
  Lens lens{camera};
  // A ray of 89.9° off the axis is the widest a pinhole model can mean; a fisheye may look behind itself.
  const bool fisheye = camera.distortion_model == DistortionModel::kFisheye;
  const double widest = fisheye ? std::numbers::pi : std::tan(89.9 * std::numbers::pi / 180);
  const RadialCoefficients a = radial_coefficients(camera);
  const auto folds = sign_changes({1, 3 * a[0], 5 * a[1], 7 * a[2], 9 * a[3]}, 0, widest * widest);
  lens.max_radius = folds.empty() ? widest : std::sqrt(folds.front());
  lens.max_distorted_radius = radial(a, lens.max_radius).value;
  return lens;
}

std::optional<Eigen::Vector2d> pixel_from_ray(const Lens& lens, const Eigen::Vector3d& ray) {
  const Camera& camera = lens.camera;
  Eigen::Vector2d point;
  if (camera.distortion_model == DistortionModel::kFisheye) {
    const double across = std::hypot(ray.x(), ray.y());
    const double theta = std::atan2(across, ray.z());
    if (!(theta <= lens.max_radius)) return std::nullopt;
    const double distorted = radial(radial_coefficients(camera), theta).value;
    if (across > 0) {
      point = ray.head<2>() * (distorted / across);
    } else {
      if (!(ray.z() > 0)) return std::nullopt;
      point.setZero();
    }
  } else {
    if (!(ray.z() > 0)) return std::nullopt;
    point = ray.head<2>() / ray.z();
    if (!(point.squaredNorm() <= lens.max_radius * lens.max_radius)) return std::nullopt;
    if (camera.distortion_model == DistortionModel::kBrownConrady) {
      point = brown_conrady(camera, radial_coefficients(camera), point);
    }
  }
  return Eigen::Vector2d(camera.fx_px * point.x() + camera.cx_px, camera.fy_px * point.y() + camera.cy_px);
}

std::optional<Eigen::Vector3d> ray_from_pixel(const Lens& lens, const Eigen::Vector2d& pixel) {
  const Camera& camera = lens.camera;
  const Eigen::Vector2d distorted((pixel.x() - camera.cx_px) / camera.fx_px, (pixel.y() - camera.cy_px) / camera.fy_px);
  // Farther out nothing can be seen, and squares would overflow.
  if (!(std::abs(distorted.x()) <= 1e9 && std::abs(distorted.y()) <= 1e9)) return std::nullopt;
  if (camera.distortion_model == DistortionModel::kFisheye) {
    const double distorted_radius = distorted.norm();
    if (distorted_radius > lens.max_distorted_radius) return std::nullopt;
    if (distorted_radius == 0) return Eigen::Vector3d(0, 0, 1);
    const double theta = undistorted_radius(radial_coefficients(camera), distorted_radius, lens.max_radius);
    const Eigen::Vector2d across = distorted * (std::sin(theta) / distorted_radius);
    return Eigen::Vector3d(across.x(), across.y(), std::cos(theta));
  }
  Eigen::Vector2d point = distorted;
  if (camera.distortion_model == DistortionModel::kBrownConrady) {
    const auto undistorted = undistort_brown_conrady(lens, distorted);
    if (!undistorted) return std::nullopt;
    point = *undistorted;
  } else if (point.norm() > lens.max_radius) {
    return std::nullopt;
  }
  return Eigen::Vector3d(point.x(), point.y(), 1).normalized();
}

}  // namespace pilotage
