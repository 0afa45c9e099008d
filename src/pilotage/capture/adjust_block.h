#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/capture/block.h"
#include "pilotage/capture/block_start.h"

namespace pilotage {

/// A point that was adjusted with the frames.
struct AdjustedPoint {
  Eigen::Vector3d enu_m{0, 0, 0};
  Track sightings;  ///< Those that were kept.
};

/// How far a control point lies from where the worst of its marks sees it, and from where it was given, together.
struct ControlMiss {
  double miss_m = 0;
  int frame = 0;  ///< Of that mark.
};

/// What an adjustment leaves unknown of a frame, together: the turn about the camera's axes (rad), its centre (east,
/// north, up; m), the lens (log of the focal length's factor, k1, k2), and the ground below it (height at its nadir, m;
/// slope to the east and to the north). Covariance of the truth less what was adjusted; frame_errors.h.
struct FrameError {
  static constexpr int kSize = 12;
  Eigen::Matrix<double, kSize, kSize> covariance;
  /// Of the ground below, to the east and to the north, where it is the plane through the points seen and moves with
  /// the block; nothing over an elevation model.
  std::optional<Eigen::RowVector2d> ground_slope;
};

/// A block after its adjustment.
struct AdjustedBlock {
  std::vector<FramePose> poses;
  Camera camera;  ///< As adjusted: focal length, k1, k2.
  std::vector<AdjustedPoint> points;
  Eigen::Vector3d position_bias_m{0, 0, 0};  ///< Measured less adjusted, common to all frames.
  double clock_offset_s = 0;                 ///< Frames were taken so much later than their position says.
  Eigen::Vector3d boresight_deg{0, 0, 0};    ///< Turn of the camera against its measured attitude, about its x, y, z.
  std::vector<Eigen::Vector3d> position_residuals_m;  ///< Measured less adjusted less what is common; per frame.
  std::vector<ControlMiss> control_misses;
  std::vector<double>
      tie_misses_m;  ///< How far each tie lies from where the other map has it less what that misses alike.
  /// The plane that holds the block from bending, where no elevation model does: slopes to the east and to the north,
  /// height at the origin.
  std::optional<Eigen::Vector3d> plane;
  std::vector<FrameError> frame_errors;
  double reprojection_rms_px = 0;    ///< Of the kept sightings, both axes together.
  std::vector<double> frame_rms_px;  ///< The same per frame; NaN for one without sightings.
  std::vector<int> frame_sightings;  ///< Kept, per frame.
  std::int64_t sightings = 0;        ///< Kept, of
  std::int64_t sightings_before = 0;
  bool converged = false;  ///< Else the iterations ended before the changes did.
};

/// Height of the ground at east and north, where it is known (NaN elsewhere), and how well.
struct GroundPrior {
  std::function<double(const Eigen::Vector2d& en_m)> height_m;  ///< Empty: a plane through the points themselves.
  double sigma_m = 3;
};

/// Bundle adjustment (B. Triggs et al., "Bundle adjustment — a modern synthesis", 2000; solved by Ceres, Schur
/// complement by sparse Cholesky): poses, ground points, focal length, k1, k2, boresight, bias and clock offset of the
/// positions. Reprojection errors and measured poses count by Cauchy's loss. The prior on the points' heights weighs,
/// all together, as much as one height in each of 5 × 5 parts of the block, so that it holds the block from bending
/// as a whole and leaves relief alone; where it is a plane, that is adjusted, too, so that slopes stay what they are.
/// A tie to another map is a point that one frame sees, with a height over that plane or the elevation model, and by
/// Cauchy's loss where the other map has it, less a bias that all ties share.
/// Twice, without the sightings that miss by more than four standard deviations after the first time, and these are
/// left out of the result as well. One thread, so that the result has the same digits everywhere; what it leaves
/// unknown of the frames is computed by `threads`. Throws DataError when too little is left, Interrupted.
AdjustedBlock adjust_block(const Block& block, const BlockStart& start, const std::vector<Track>& tracks,
                           const GroundPrior& ground, int threads, const Progress& progress);

}  // namespace pilotage
