#pragma once

#include <optional>

#include <Eigen/Core>

#include "pilotage/camera/camera.h"

namespace pilotage {

/// The part of a camera between rays and pixels, with the domain on which its distortion can be inverted.
///
/// Distortion polynomials turn back on themselves far off the axis, where a ray outside the field of view would land
/// inside the image. `max_radius` is the end of the branch through the axis: the first zero of the derivative of the
/// radial polynomial. Rays and pixels beyond it have no counterpart.
struct Lens {
  Camera camera;
  /// Brown–Conrady: largest x² + y² before distortion, as its root; fisheye: largest angle off the axis in radians.
  double max_radius = 0;
  double max_distorted_radius = 0;  ///< Image of max_radius under the radial polynomial.
};

/// Throws DataError when camera_problem() finds one.
Lens make_lens(const Camera& camera);

/// The pixel that sees along `ray` (camera frame, any length; z > 0 unless the lens is a fisheye). Nothing outside the
/// lens's domain; the pixel may lie outside the image. Closed form.
/// Brown–Conrady: x' = x (1 + k1 r² + k2 r⁴ + k3 r⁶) + 2 p1 x y + p2 (r² + 2 x²), likewise y' (OpenCV's calib3d).
/// Fisheye: θ' = θ (1 + k1 θ² + k2 θ⁴ + k3 θ⁶ + k4 θ⁸) (J. Kannala, S. Brandt, PAMI 2006, Eq. 6).
std::optional<Eigen::Vector2d> pixel_from_ray(const Lens& lens, const Eigen::Vector3d& ray);

/// The unit ray (camera frame) of a pixel, inverse of pixel_from_ray: the pixel of the ray differs by less than 1e-6
/// px. Nothing when the pixel is outside the lens's domain. Bracketed Newton on the radius, then Newton in two
/// dimensions.
std::optional<Eigen::Vector3d> ray_from_pixel(const Lens& lens, const Eigen::Vector2d& pixel);

}  // namespace pilotage
