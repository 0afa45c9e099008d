#pragma once

#include <cmath>
#include <numbers>

#include "match/chip_scene.h"
#include "testing/features_of_image.h"

#include "pilotage/match/displacement_voting.h"
#include "pilotage/vision/features.h"

namespace pilotage::testing {

/// Ground of texture as a map, and a frame of it whose placement is known.
struct PlacedScene {
  LocalMap map;
  PivotedFrame frame;
  Placement truth;
  SearchSpace space;  ///< ± 40 px about a place some pixels beside the truth, ± 1° and 3 %.
};

inline void set_radius(PivotedFrame& frame) {
  for (const Feature& point : frame.grid.points.features) {
    const Eigen::Vector2d place(static_cast<double>(point.x_px), static_cast<double>(point.y_px));
    frame.radius_px = std::max(frame.radius_px, (place - frame.pivot_px).norm());
  }
}

inline PlacedScene make_placed_scene(const Placement& truth, const FeatureOptions& options = {}) {
  constexpr double kDegPerRad = 180 / std::numbers::pi;
  const cv::Mat ground = random_ground(420, 400, 7);
  PlacedScene scene;
  scene.truth = truth;
  scene.map.features = features_of_image(ground, options);
  const RectifiedFrame frame =
      frame_over(ground, truth.center_px, 150, 120, 20, truth.yaw_rad * kDegPerRad, truth.scale);
  scene.frame.grid = describe_frame_grid(frame, options);
  scene.frame.pivot_px = {frame.gray.cols / 2.0, frame.gray.rows / 2.0};
  set_radius(scene.frame);
  scene.space.center_px = truth.center_px + Eigen::Vector2d(17, -23);
  scene.space.half_width_px = 40;
  scene.space.yaw_sigma_rad = 1 / kDegPerRad;
  scene.space.scale_sigma = 0.03;
  return scene;
}

inline double angle_between(double a_rad, double b_rad) {
  return std::abs(std::remainder(a_rad - b_rad, 2 * std::numbers::pi));
}

}  // namespace pilotage::testing
