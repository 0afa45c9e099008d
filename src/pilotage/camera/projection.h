#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pilotage/camera/attitude.h"
#include "pilotage/camera/camera.h"
#include "pilotage/camera/lens.h"

namespace pilotage {

/// A camera in the air over flat ground. Ground points are (east, north) in metres from the point straight below the
/// camera.
struct View {
  Lens lens;
  Eigen::Matrix3d enu_from_camera;
  double agl_m = 0;  ///< Height above the ground.
  /// Ground farther than agl_m times this from the point below is not seen: beyond it the horizon begins.
  double max_off_nadir_tan = 0;
};

/// Nothing when the attitude is not finite, when `agl_m` is not in (0, 1e6], or when the camera has a problem. Never
/// throws.
std::optional<View> make_view(const Camera& camera, const Attitude& attitude, double agl_m,
                              double max_off_nadir_deg = 80);

/// Where the ray of `pixel` meets the ground. Nothing when it points farther than View::max_off_nadir_tan or the pixel
/// is outside the lens's domain; pixels outside the image are answered like others.
std::optional<Eigen::Vector2d> ground_from_pixel(const View& view, const Eigen::Vector2d& pixel);

/// The same of a ray, in the camera's frame.
std::optional<Eigen::Vector2d> ground_from_ray(const View& view, const Eigen::Vector3d& ray_camera);

/// Where a point of the ground appears. Nothing when it lies behind the camera, beyond max_off_nadir_tan or outside the
/// lens's domain; the pixel may lie outside the image.
std::optional<Eigen::Vector2d> pixel_from_ground(const View& view, const Eigen::Vector2d& ground_m);

/// Points of the ground whose pixels are worked out together.
inline constexpr std::size_t kPointsTogether = 8;

/// What pixel_from_ground() says of several points.
struct PixelsTogether {
  std::array<bool, kPointsTogether> seen{};  ///< Else the pixel is none.
  std::array<double, kPointsTogether> x_px{};
  std::array<double, kPointsTogether> y_px{};
};

/// pixel_from_ground() of points in a row from west to east, by wide instructions where the machine has them (not for a
/// fisheye). The pixels are the same but for rounding.
PixelsTogether pixels_from_ground(const View& view, const std::array<double, kPointsTogether>& east_m, double north_m);

/// The ground that a frame shows.
struct Footprint {
  /// Outline (east, north), from the frame's top left corner clockwise around the image; several points a side, so that
  /// distortion is followed. Empty when no ground is seen.
  std::vector<Eigen::Vector2d> polygon_m;
  double area_m2 = 0;
  Eigen::Vector2d center_m{0, 0};  ///< Centroid of the polygon.
  double across_m =
      0;  ///< Mean ground length of the outline's left-right extent: between the middles of its left and right side.
  double along_m = 0;             ///< The same between the middles of its top and bottom side.
  double inscribed_radius_m = 0;  ///< Largest circle around center_m inside the outline.
  bool cut = false;  ///< Part of the frame shows no ground (horizon or edge of the lens); the outline is cut there.
};

/// `footprint` of a view; an empty polygon when nothing is seen.
Footprint footprint(const View& view);

/// The same; empty for any camera, attitude or height from which no view can be made. Never throws.
Footprint footprint(const Camera& camera, const Attitude& attitude, double agl_m);

/// Ground length of one pixel at the principal point, looking straight down.
struct GroundSampleDistance {
  double across_m = 0;
  double along_m = 0;
};
GroundSampleDistance gsd_m(const Camera& camera, double agl_m);

}  // namespace pilotage
