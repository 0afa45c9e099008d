#pragma once

#include <cmath>

#include <Eigen/Core>

namespace pilotage {

// Positions on the map are pixels of its level relative to LocalMap::reference_px, x right, y down. A frame is placed
// on the map by a similarity about the frame's pivot, the ground under the camera's principal point:
//   place on the map = center_px + scale · R(yaw) · (pixel of the frame − pivot)
// with R turning clockwise by yaw, as headings do.

/// A frame on the map.
struct Placement {
  Eigen::Vector2d center_px{0, 0};
  double yaw_rad = 0;  ///< Against the prior yaw.
  double scale = 1;

  Eigen::Vector2d map_from_frame(const Eigen::Vector2d& from_pivot_px) const;
  Eigen::Vector2d frame_from_map(const Eigen::Vector2d& map_px) const;
};

/// A placement's two functions for many points: the sine and cosine are at hand, the numbers are the same to the bit.
class PlacementTransform {
 public:
  explicit PlacementTransform(const Placement& placement)
      : center_px_(placement.center_px),
        scale_(placement.scale),
        cosine_(std::cos(placement.yaw_rad)),
        sine_(std::sin(placement.yaw_rad)),
        scaled_cosine_(scale_ * cosine_),
        scaled_sine_(scale_ * sine_) {}

  Eigen::Vector2d map_from_frame(const Eigen::Vector2d& from_pivot_px) const {
    return center_px_ + Eigen::Vector2d(scaled_cosine_ * from_pivot_px.x() - scaled_sine_ * from_pivot_px.y(),
                                        scaled_sine_ * from_pivot_px.x() + scaled_cosine_ * from_pivot_px.y());
  }
  Eigen::Vector2d frame_from_map(const Eigen::Vector2d& map_px) const {
    const Eigen::Vector2d d = (map_px - center_px_) / scale_;
    return {cosine_ * d.x() + sine_ * d.y(), -sine_ * d.x() + cosine_ * d.y()};
  }

 private:
  Eigen::Vector2d center_px_;
  double scale_;
  double cosine_;
  double sine_;
  double scaled_cosine_;
  double scaled_sine_;
};

inline Eigen::Vector2d Placement::map_from_frame(const Eigen::Vector2d& from_pivot_px) const {
  return PlacementTransform(*this).map_from_frame(from_pivot_px);
}

inline Eigen::Vector2d Placement::frame_from_map(const Eigen::Vector2d& map_px) const {
  return PlacementTransform(*this).frame_from_map(map_px);
}

}  // namespace pilotage
