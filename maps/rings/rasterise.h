#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pilotage/camera/attitude.h"
#include "pilotage/camera/camera.h"

namespace pilotage {

using Paint = std::array<std::uint8_t, 3>;

/// A flat triangle of one colour, seen from both sides; corners east, north, up in metres.
struct Triangle {
  std::array<Eigen::Vector3d, 3> corners;
  Paint color{};
};
using Mesh = std::vector<Triangle>;

/// A torus: `center`, unit `normal` of its plane, radius of the circle in its middle, radius of the tube.
void add_torus(Mesh& mesh, const Eigen::Vector3d& center, const Eigen::Vector3d& normal, double radius_m, double tube_m,
               Paint color);
/// An upright post with six sides, from the ground to `top`.
void add_post(Mesh& mesh, const Eigen::Vector3d& top, double radius_m, Paint color);
/// A flat disc with `corners` corners at `outer_m`, with a hole of radius `inner_m` of the same shape unless that is 0.
void add_disc(Mesh& mesh, const Eigen::Vector3d& center, const Eigen::Vector3d& normal, double inner_m, double outer_m,
              int corners, Paint color);

/// Flat ground at height 0 with a picture on it.
struct GroundPicture {
  /// CV_8UC3, red, green, blue; the whole picture, then halved again and again.
  std::vector<cv::Mat> halvings;
  Eigen::Vector2d origin_px{0, 0};  ///< East = north = 0, in pixels of the whole picture, centres at +0.5.
  Eigen::Matrix2d pixel_from_enu_m = Eigen::Matrix2d::Identity();
};
GroundPicture make_ground_picture(const cv::Mat& rgb, const Eigen::Vector2d& origin_px,
                                  const Eigen::Matrix2d& pixel_from_enu_m);

/// Where a camera without distortion is.
struct CameraPose {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  ///< East, north, up.
  Eigen::Matrix3d enu_from_camera = Eigen::Matrix3d::Identity();
};

struct RasterisedFrame {
  cv::Mat rgb;      ///< CV_8UC3 of the camera's size.
  cv::Mat inverse;  ///< CV_32F: 1 / depth along the view, of the finer picture that `rgb` is the mean of; 0: sky.
};

/// The ground and the triangles as the camera sees them: twice as many pixels along each side as it has, the nearest
/// surface in each by a depth buffer, then the mean of four. Triangles that reach behind 5 cm before the camera are
/// left out. Light: the color of a triangle by how far it faces up, the ground as in its picture; nothing casts a
/// shadow. Throws UsageError for a camera with distortion or one that camera_problem() refuses.
RasterisedFrame rasterise(const Mesh& mesh, const GroundPicture& ground, const Camera& camera, const CameraPose& pose);

}  // namespace pilotage
