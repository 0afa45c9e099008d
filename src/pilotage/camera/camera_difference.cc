#include "pilotage/camera/camera_difference.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include <Eigen/Geometry>

#include "pilotage/base/error.h"
#include "pilotage/camera/attitude.h"
#include "pilotage/camera/lens.h"

namespace pilotage {
namespace {

/// The direction, seen from the aircraft, of a place of the image: (0, 0) top left, (1, 1) bottom right.
std::optional<Eigen::Vector3d> direction(const Lens& lens, const Eigen::Vector2d& place) {
  const std::optional<Eigen::Vector3d> ray =
      ray_from_pixel(lens, {place.x() * lens.camera.width_px, place.y() * lens.camera.height_px});
  if (!ray) return std::nullopt;
  return body_from_camera(lens.camera.mount) * *ray;
}

bool same_shape(const Camera& a, const Camera& b) {
  try {
    camera_for_size("", a, b.width_px, b.height_px);
    return true;
  } catch (const DataError&) {
    return false;
  }
}

}  // namespace

double camera_difference_deg(const Camera& a, const Camera& b) {
  const Lens lens_a = make_lens(a);
  const Lens lens_b = make_lens(b);
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  if (!same_shape(a, b)) return kInfinite;
  double largest_rad = 0;
  for (const double x : {0.0, 0.5, 1.0}) {
    for (const double y : {0.0, 0.5, 1.0}) {
      const auto from_a = direction(lens_a, {x, y});
      const auto from_b = direction(lens_b, {x, y});
      if (!from_a || !from_b) return kInfinite;
      largest_rad = std::max(largest_rad, std::atan2(from_a->cross(*from_b).norm(), from_a->dot(*from_b)));
    }
  }
  return largest_rad * 180 / std::numbers::pi;
}

}  // namespace pilotage
