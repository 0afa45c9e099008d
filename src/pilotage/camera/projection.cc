#include "pilotage/camera/projection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "pilotage/base/wide_clones.h"

namespace pilotage {
namespace {

constexpr int kPointsPerSide = 32;  // a multiple of 2: the middle of each side is a point
constexpr int kAnchorGrid = 33;

double max_distance(const View& view) {
  return view.agl_m * view.max_off_nadir_tan;
}

/// The point of the image that shows ground and lies nearest to its middle, of a regular grid with the middle on it.
std::optional<Eigen::Vector2d> ground_showing_pixel(const View& view) {
  const Eigen::Vector2d size(view.lens.camera.width_px, view.lens.camera.height_px);
  if (ground_from_pixel(view, size / 2)) return size / 2;
  std::optional<Eigen::Vector2d> nearest;
  double nearest_distance = std::numeric_limits<double>::infinity();
  for (int row = 0; row < kAnchorGrid; ++row) {
    for (int col = 0; col < kAnchorGrid; ++col) {
      const Eigen::Vector2d pixel = size.cwiseProduct(Eigen::Vector2d(col, row)) / (kAnchorGrid - 1);
      const double distance = (pixel - size / 2).norm();
      if (distance < nearest_distance && ground_from_pixel(view, pixel)) {
        nearest = pixel;
        nearest_distance = distance;
      }
    }
  }
  return nearest;
}

/// A view as plain numbers: of a ground point's ray, the part that all points share, and what a metre east adds.
struct WideView {
  double east_x;
  double east_y;
  double east_z;
  double common_x;
  double common_y;
  double common_z;
  double north_m;
  double max_distance2_m2;
  double max_radius2;
  double k1;
  double k2;
  double k3;
  double p1;
  double p2;
  double fx_px;
  double fy_px;
  double cx_px;
  double cy_px;

  WideView(const View& view, double north) : north_m(north) {
    const Eigen::Matrix3d camera_from_enu = view.enu_from_camera.transpose();
    const Eigen::Vector3d common = camera_from_enu * Eigen::Vector3d(0, north, -view.agl_m);
    east_x = camera_from_enu(0, 0);
    east_y = camera_from_enu(1, 0);
    east_z = camera_from_enu(2, 0);
    common_x = common.x();
    common_y = common.y();
    common_z = common.z();
    max_distance2_m2 = max_distance(view) * max_distance(view);
    max_radius2 = view.lens.max_radius * view.lens.max_radius;
    const Camera& camera = view.lens.camera;
    const bool is_distorted = camera.distortion_model == DistortionModel::kBrownConrady;
    k1 = is_distorted ? camera.distortion[0] : 0;
    k2 = is_distorted ? camera.distortion[1] : 0;
    p1 = is_distorted ? camera.distortion[2] : 0;
    p2 = is_distorted ? camera.distortion[3] : 0;
    k3 = is_distorted ? camera.distortion[4] : 0;
    fx_px = camera.fx_px;
    fy_px = camera.fy_px;
    cx_px = camera.cx_px;
    cy_px = camera.cy_px;
  }
};

static_assert(kPointsTogether == kTogether);

/// Where the points appear, and how far they are from not being seen: not at all where `ahead` is not above 0 or
/// `within` below it.
struct WidePixels {
  Together x_px;
  Together y_px;
  Together ahead;
  Together within;
};

PILOTAGE_WIDE_CLONES
void project(const WideView& view, const double* east_m, WidePixels& pixels) {
  const WideView by = view;
  WidePixels found;
  for (std::size_t i = 0; i < kPointsTogether; ++i) {
    const double east = east_m[i];
    const double ahead = by.east_z * east + by.common_z;
    const double x = (by.east_x * east + by.common_x) / ahead;
    const double y = (by.east_y * east + by.common_y) / ahead;
    const double u = x * x + y * y;
    const double factor = 1 + u * (by.k1 + u * (by.k2 + u * by.k3));
    found.x_px[i] = by.fx_px * (x * factor + 2 * by.p1 * x * y + by.p2 * (u + 2 * x * x)) + by.cx_px;
    found.y_px[i] = by.fy_px * (y * factor + by.p1 * (u + 2 * y * y) + 2 * by.p2 * x * y) + by.cy_px;
    found.ahead[i] = ahead;
    found.within[i] = std::min(by.max_distance2_m2 - (east * east + by.north_m * by.north_m), by.max_radius2 - u);
  }
  pixels = found;
}

/// The ground seen farthest along the segment from `anchor`, which shows ground, to `pixel`.
Eigen::Vector2d last_ground_towards(const View& view, const Eigen::Vector2d& anchor, const Eigen::Vector2d& pixel) {
  double seen = 0;
  double unseen = 1;
  Eigen::Vector2d ground = *ground_from_pixel(view, anchor);
  for (int step = 0; step < 40; ++step) {
    const double middle = (seen + unseen) / 2;
    const auto point = ground_from_pixel(view, anchor + middle * (pixel - anchor));
    (point ? seen : unseen) = middle;
    if (point) ground = *point;
  }
  return ground;
}

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

double distance_to_segment(const Eigen::Vector2d& point, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = b - a;
  const double length2 = along.squaredNorm();
  const double t = length2 > 0 ? std::clamp((point - a).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (a + t * along - point).norm();
}

/// Area and centroid by the shoelace formula, relative to the first point so that small far polygons keep their digits.
void measure(Footprint& footprint) {
  const auto& polygon = footprint.polygon_m;
  const Eigen::Vector2d origin = polygon.front();
  double twice_area = 0;
  Eigen::Vector2d moment(0, 0);
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d a = polygon[i] - origin;
    const Eigen::Vector2d b = polygon[(i + 1) % polygon.size()] - origin;
    twice_area += cross(a, b);
    moment += cross(a, b) * (a + b);
  }
  footprint.area_m2 = std::abs(twice_area) / 2;
  footprint.center_m = twice_area != 0 ? Eigen::Vector2d(origin + moment / (3 * twice_area)) : origin;
  double radius = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    radius = std::min(radius, distance_to_segment(footprint.center_m, polygon[i], polygon[(i + 1) % polygon.size()]));
  }
  footprint.inscribed_radius_m = radius;
  const auto middle = [&](int side) {
    return polygon[static_cast<std::size_t>(side * kPointsPerSide + kPointsPerSide / 2)];
  };
  footprint.along_m = (middle(0) - middle(2)).norm();
  footprint.across_m = (middle(1) - middle(3)).norm();
}

}  // namespace

std::optional<View> make_view(const Camera& camera, const Attitude& attitude, double agl_m, double max_off_nadir_deg) {
  if (!camera_problem(camera).empty()) return std::nullopt;
  if (!std::isfinite(attitude.yaw_deg) || !std::isfinite(attitude.pitch_deg) || !std::isfinite(attitude.roll_deg)) {
    return std::nullopt;
  }
  if (!(agl_m > 0 && agl_m <= 1e6)) return std::nullopt;
  if (!(max_off_nadir_deg > 0 && max_off_nadir_deg < 89.9)) return std::nullopt;
  return View{make_lens(camera), enu_from_camera(camera.mount, attitude), agl_m,
              std::tan(max_off_nadir_deg * std::numbers::pi / 180)};
}

std::optional<Eigen::Vector2d> ground_from_pixel(const View& view, const Eigen::Vector2d& pixel) {
  const auto ray_camera = ray_from_pixel(view.lens, pixel);
  return ray_camera ? ground_from_ray(view, *ray_camera) : std::nullopt;
}

std::optional<Eigen::Vector2d> ground_from_ray(const View& view, const Eigen::Vector3d& ray_camera) {
  const Eigen::Vector3d ray = view.enu_from_camera * ray_camera;
  if (!(ray.z() < 0)) return std::nullopt;
  const Eigen::Vector2d ground = ray.head<2>() * (view.agl_m / -ray.z());
  if (!(ground.norm() <= max_distance(view))) return std::nullopt;
  return ground;
}

std::optional<Eigen::Vector2d> pixel_from_ground(const View& view, const Eigen::Vector2d& ground_m) {
  if (!(ground_m.norm() <= max_distance(view))) return std::nullopt;
  const Eigen::Vector3d ray(ground_m.x(), ground_m.y(), -view.agl_m);
  return pixel_from_ray(view.lens, view.enu_from_camera.transpose() * ray);
}

PixelsTogether pixels_from_ground(const View& view, const std::array<double, kPointsTogether>& east_m, double north_m) {
  PixelsTogether pixels;
  if (view.lens.camera.distortion_model == DistortionModel::kFisheye) {
    for (std::size_t i = 0; i < kPointsTogether; ++i) {
      const auto pixel = pixel_from_ground(view, {east_m[i], north_m});
      pixels.seen[i] = pixel.has_value();
      pixels.x_px[i] = pixel ? pixel->x() : 0;
      pixels.y_px[i] = pixel ? pixel->y() : 0;
    }
    return pixels;
  }
  WidePixels wide;
  project(WideView(view, north_m), east_m.data(), wide);
  pixels.x_px = wide.x_px;
  pixels.y_px = wide.y_px;
  for (std::size_t i = 0; i < kPointsTogether; ++i) pixels.seen[i] = wide.ahead[i] > 0 && wide.within[i] >= 0;
  return pixels;
}

Footprint footprint(const View& view) {
  Footprint footprint;
  const auto anchor = ground_showing_pixel(view);
  if (!anchor) return footprint;
  const double width = view.lens.camera.width_px;
  const double height = view.lens.camera.height_px;
  const std::array<Eigen::Vector2d, 5> corners{Eigen::Vector2d(0, 0), Eigen::Vector2d(width, 0),
                                               Eigen::Vector2d(width, height), Eigen::Vector2d(0, height),
                                               Eigen::Vector2d(0, 0)};
  for (std::size_t side = 0; side < 4; ++side) {
    for (int step = 0; step < kPointsPerSide; ++step) {
      const double t = static_cast<double>(step) / kPointsPerSide;
      const Eigen::Vector2d pixel = corners[side] + t * (corners[side + 1] - corners[side]);
      const auto ground = ground_from_pixel(view, pixel);
      footprint.cut |= !ground;
      footprint.polygon_m.push_back(ground ? *ground : last_ground_towards(view, *anchor, pixel));
    }
  }
  measure(footprint);
  return footprint;
}

Footprint footprint(const Camera& camera, const Attitude& attitude, double agl_m) {
  const auto view = make_view(camera, attitude, agl_m);
  return view ? footprint(*view) : Footprint{};
}

GroundSampleDistance gsd_m(const Camera& camera, double agl_m) {
  return {agl_m / camera.fx_px, agl_m / camera.fy_px};
}

}  // namespace pilotage
