#include "rasterise.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

constexpr int kFiner = 2;
constexpr double kNearest_m = 0.05;
constexpr int kRoundTorus = 64;
constexpr int kRoundTube = 24;
constexpr Paint kSky = {185, 205, 225};

/// Two unit vectors that span the plane of a normal, the first level.
std::array<Eigen::Vector3d, 2> plane_of(const Eigen::Vector3d& normal) {
  const Eigen::Vector3d aside = normal.cross(Eigen::Vector3d::UnitZ());
  const Eigen::Vector3d first = aside.norm() > 1e-6 ? aside.normalized() : Eigen::Vector3d::UnitX();
  return {first, first.cross(normal).normalized()};
}

void add_quadrilateral(Mesh& mesh, const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                       const Eigen::Vector3d& d, Paint color) {
  mesh.push_back({{a, b, c}, color});
  mesh.push_back({{a, c, d}, color});
}

/// The color of a triangle in the light of the sky, a little of it from one side.
Paint lit(const Triangle& triangle) {
  const Eigen::Vector3d across =
      (triangle.corners[1] - triangle.corners[0]).cross(triangle.corners[2] - triangle.corners[0]);
  const double facing = across.norm() > 0 ? std::abs(across.normalized().dot(Eigen::Vector3d(0.3, -0.5, 0.81))) : 0;
  const double light = 0.65 + 0.35 * facing;
  Paint color{};
  for (std::size_t i = 0; i < 3; ++i) color[i] = static_cast<std::uint8_t>(std::lround(light * triangle.color[i]));
  return color;
}

/// The camera with finer pixels.
struct FineCamera {
  Camera camera;
  Eigen::Matrix3d camera_from_enu;
  Eigen::Vector3d position_m;

  Eigen::Vector3d ray(double x, double y) const {
    return {(x - camera.cx_px) / camera.fx_px, (y - camera.cy_px) / camera.fy_px, 1};
  }
};

FineCamera make_fine_camera(const Camera& camera, const CameraPose& pose) {
  if (const std::string problem = camera_problem(camera); !problem.empty()) throw UsageError("camera: " + problem);
  if (camera.distortion_model != DistortionModel::kNone) throw UsageError("camera: one without distortion is needed");
  return {resized_camera(camera, kFiner * camera.width_px, kFiner * camera.height_px), pose.enu_from_camera.transpose(),
          pose.position_m};
}

cv::Vec3f ground_color(const GroundPicture& ground, const Eigen::Vector2d& at_px, double side_px) {
  const int most = static_cast<int>(ground.halvings.size()) - 1;
  const int level = std::clamp(static_cast<int>(std::lround(std::log2(std::max(1.0, side_px)))), 0, most);
  const cv::Mat& picture = ground.halvings[static_cast<std::size_t>(level)];
  const Eigen::Vector2d at = at_px / (1 << level) - Eigen::Vector2d::Constant(0.5);
  const double left = std::clamp(std::floor(at.x()), 0.0, picture.cols - 2.0);
  const double top = std::clamp(std::floor(at.y()), 0.0, picture.rows - 2.0);
  const auto x = static_cast<float>(std::clamp(at.x() - left, 0.0, 1.0));
  const auto y = static_cast<float>(std::clamp(at.y() - top, 0.0, 1.0));
  const auto* upper = picture.ptr<cv::Vec3b>(static_cast<int>(top)) + static_cast<int>(left);
  const auto* lower = picture.ptr<cv::Vec3b>(static_cast<int>(top) + 1) + static_cast<int>(left);
  return (1 - y) * ((1 - x) * cv::Vec3f(upper[0]) + x * cv::Vec3f(upper[1])) +
         y * ((1 - x) * cv::Vec3f(lower[0]) + x * cv::Vec3f(lower[1]));
}

void draw_ground(RasterisedFrame& frame, const GroundPicture& ground, const FineCamera& fine) {
  const Eigen::Matrix3d enu_from_camera = fine.camera_from_enu.transpose();
  const double px_per_m = std::sqrt(std::abs(ground.pixel_from_enu_m.determinant()));
  for (int row = 0; row < frame.rgb.rows; ++row) {
    for (int col = 0; col < frame.rgb.cols; ++col) {
      const Eigen::Vector3d ray = enu_from_camera * fine.ray(col + 0.5, row + 0.5);
      if (!(ray.z() < -1e-6)) continue;
      const double depth_m = fine.position_m.z() / -ray.z();
      const Eigen::Vector2d at_m = (fine.position_m + depth_m * ray).head<2>();
      // The mean of the pixel's length and width on the ground.
      const double side_m = depth_m / fine.camera.fx_px * std::sqrt(ray.norm() / -ray.z());
      const cv::Vec3f color =
          ground_color(ground, ground.origin_px + ground.pixel_from_enu_m * at_m, side_m * px_per_m);
      frame.rgb.at<cv::Vec3b>(row, col) = cv::Vec3b(color);
      frame.inverse.at<float>(row, col) = static_cast<float>(1 / depth_m);
    }
  }
}

/// Twice the signed area of the triangle a, b, p.
double edge(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double x, double y) {
  return (b.x() - a.x()) * (y - a.y()) - (b.y() - a.y()) * (x - a.x());
}

void draw_triangle(RasterisedFrame& frame, const Triangle& triangle, const FineCamera& fine) {
  std::array<Eigen::Vector3d, 3> seen;  // pixel, and 1 / depth, which is linear over the picture
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::Vector3d at_m = fine.camera_from_enu * (triangle.corners[i] - fine.position_m);
    if (at_m.z() < kNearest_m) return;
    seen[i] = {fine.camera.cx_px + fine.camera.fx_px * at_m.x() / at_m.z(),
               fine.camera.cy_px + fine.camera.fy_px * at_m.y() / at_m.z(), 1 / at_m.z()};
  }
  const double area = edge(seen[0], seen[1], seen[2].x(), seen[2].y());
  if (area == 0) return;
  const auto [left, right] = std::minmax({seen[0].x(), seen[1].x(), seen[2].x()});
  const auto [top, bottom] = std::minmax({seen[0].y(), seen[1].y(), seen[2].y()});
  if (right < 0 || bottom < 0 || left > frame.rgb.cols || top > frame.rgb.rows) return;
  const Paint color = lit(triangle);
  const int last_row = static_cast<int>(std::min(frame.rgb.rows - 1.0, bottom));
  const int last_col = static_cast<int>(std::min(frame.rgb.cols - 1.0, right));
  for (int row = static_cast<int>(std::max(0.0, top)); row <= last_row; ++row) {
    for (int col = static_cast<int>(std::max(0.0, left)); col <= last_col; ++col) {
      const double x = col + 0.5;
      const double y = row + 0.5;
      const double a = edge(seen[1], seen[2], x, y) / area;
      const double b = edge(seen[2], seen[0], x, y) / area;
      const double c = 1 - a - b;
      if (a < 0 || b < 0 || c < 0) continue;
      const auto inverse = static_cast<float>(a * seen[0].z() + b * seen[1].z() + c * seen[2].z());
      if (inverse <= frame.inverse.at<float>(row, col)) continue;
      frame.inverse.at<float>(row, col) = inverse;
      frame.rgb.at<cv::Vec3b>(row, col) = cv::Vec3b(color[0], color[1], color[2]);
    }
  }
}

}  // namespace

void add_torus(Mesh& mesh, const Eigen::Vector3d& center, const Eigen::Vector3d& normal, double radius_m, double tube_m,
               Paint color) {
  const auto [u, v] = plane_of(normal);
  const auto at = [&, first = u, second = v](int i, int j) {
    const double around = 2 * std::numbers::pi * i / kRoundTorus;
    const double tube = 2 * std::numbers::pi * j / kRoundTube;
    const Eigen::Vector3d out = std::cos(around) * first + std::sin(around) * second;
    return Eigen::Vector3d(center + (radius_m + tube_m * std::cos(tube)) * out + tube_m * std::sin(tube) * normal);
  };
  for (int i = 0; i < kRoundTorus; ++i) {
    for (int j = 0; j < kRoundTube; ++j) {
      add_quadrilateral(mesh, at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1), color);
    }
  }
}

void add_post(Mesh& mesh, const Eigen::Vector3d& top, double radius_m, Paint color) {
  const auto at = [&](int i, double up_m) {
    const double around = 2 * std::numbers::pi * i / 6;
    return Eigen::Vector3d(top.x() + radius_m * std::cos(around), top.y() + radius_m * std::sin(around), up_m);
  };
  for (int i = 0; i < 6; ++i)
    add_quadrilateral(mesh, at(i, 0), at(i + 1, 0), at(i + 1, top.z()), at(i, top.z()), color);
}

void add_disc(Mesh& mesh, const Eigen::Vector3d& center, const Eigen::Vector3d& normal, double inner_m, double outer_m,
              int corners, Paint color) {
  const auto [u, v] = plane_of(normal);
  const auto at = [&, first = u, second = v](int i, double radius_m) {
    const double around = 2 * std::numbers::pi * (i + 0.5) / corners;
    return Eigen::Vector3d(center + radius_m * (std::cos(around) * first + std::sin(around) * second));
  };
  for (int i = 0; i < corners; ++i) {
    add_quadrilateral(mesh, at(i, inner_m), at(i, outer_m), at(i + 1, outer_m), at(i + 1, inner_m), color);
  }
}

GroundPicture make_ground_picture(const cv::Mat& rgb, const Eigen::Vector2d& origin_px,
                                  const Eigen::Matrix2d& pixel_from_enu_m) {
  if (rgb.type() != CV_8UC3 || rgb.cols < 2 || rgb.rows < 2) {
    throw UsageError("the ground's picture needs 8-bit red, green and blue and 2 x 2 pixels or more");
  }
  GroundPicture ground{{rgb}, origin_px, pixel_from_enu_m};
  while (std::min(ground.halvings.back().cols, ground.halvings.back().rows) >= 8) {
    cv::Mat half;
    cv::resize(ground.halvings.back(), half, {}, 0.5, 0.5, cv::INTER_AREA);
    ground.halvings.push_back(half);
  }
  return ground;
}

RasterisedFrame rasterise(const Mesh& mesh, const GroundPicture& ground, const Camera& camera, const CameraPose& pose) {
  const FineCamera fine = make_fine_camera(camera, pose);
  RasterisedFrame frame;
  frame.rgb = cv::Mat(fine.camera.height_px, fine.camera.width_px, CV_8UC3, cv::Scalar(kSky[0], kSky[1], kSky[2]));
  frame.inverse = cv::Mat(frame.rgb.size(), CV_32F, cv::Scalar(0));
  draw_ground(frame, ground, fine);
  for (const Triangle& triangle : mesh) draw_triangle(frame, triangle, fine);
  cv::Mat coarse;
  cv::resize(frame.rgb, coarse, {camera.width_px, camera.height_px}, 0, 0, cv::INTER_AREA);
  frame.rgb = coarse;
  return frame;
}

}  // namespace pilotage
