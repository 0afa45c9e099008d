#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pilotage/camera/camera.h"
#include "pilotage/capture/tracks.h"

namespace pilotage {

// A block is what photogrammetry calls frames that are adjusted together. Everything here is in one local frame (east,
// north, up in metres; geo/local_frame.h) whose heights are those that the frames state.

/// Where a camera is and how it looks.
struct FramePose {
  Eigen::Matrix3d enu_from_camera = Eigen::Matrix3d::Identity();
  Eigen::Vector3d center_enu_m{0, 0, 0};
};

/// What is known of a frame's pose before anything is adjusted.
struct MeasuredPose {
  Eigen::Vector3d center_enu_m{0, 0, 0};
  double sigma_en_m = 0;  ///< Of the centre's east and north, each.
  double sigma_up_m = 0;
  std::optional<Eigen::Matrix3d> enu_from_camera;
  std::optional<Eigen::Vector3d> velocity_enu_mps;  ///< For the offset between the clocks of camera and receiver.
};

/// A mark on the ground whose place was surveyed.
struct ControlPoint {
  struct Mark {
    int frame = 0;
    Eigen::Vector2d pixel{0, 0};
  };
  std::string name;
  Eigen::Vector3d enu_m{0, 0, 0};
  std::vector<Mark> marks;
};

/// A place that the block's first map shows, and another map as well, which is taken for right.
struct ReferenceTie {
  Eigen::Vector2d reference_en_m{0, 0};  ///< Where the other map has it.
  double sigma_m = 0;                    ///< Each axis, beside what the other map misses everywhere alike.
  Eigen::Vector3d enu_m{0, 0, 0};        ///< Where the first map has it, on the surface that it was laid over,
  double above_plane_m = 0;              ///< and how far that is above the block's plane (AdjustedBlock::plane).
  int frame = 0;                         ///< That the first map shows there,
  Eigen::Vector2d pixel{0, 0};           ///< and its pixel.
};

/// So few frames over level ground do not tell a focal length from a height: it is held to 1 %, and the lens likewise.
inline constexpr std::size_t kFewFrames = 30;
inline constexpr double kHeldSigma = 0.01;

/// What is adjusted.
struct Block {
  Camera camera;  ///< Pinhole with Brown–Conrady distortion; its mount is part of the measured attitudes.
  Eigen::Matrix3d body_from_camera = Eigen::Matrix3d::Identity();
  double focal_length_sigma = 0.1;  ///< Of the focal length, as a share of it.
  double distortion_sigma = 0.1;    ///< Of k1 and k2 each.
  double tilt_sigma_deg = 3;
  double heading_sigma_deg = 5;
  double position_bias_sigma_m = 5;  ///< Of what all measured centres miss alike, east and north each.
  std::vector<MeasuredPose> measured;
  std::vector<FrameFeatures> features;
  std::vector<FramePair> pairs;
  std::vector<ControlPoint> control_points;
  double control_sigma_m = 0.05;
  std::vector<ReferenceTie> reference_ties;
  double reference_sigma_m = 1;  ///< Of what the other map misses everywhere alike, each axis.
  double surface_sigma_m = 1;    ///< Of a tie's height over the surface that the first map was laid over.
};

}  // namespace pilotage
