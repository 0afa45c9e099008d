#pragma once

#include <vector>

#include <ceres/crs_matrix.h>

#include "pilotage/capture/adjust_block.h"

namespace pilotage {

/// What an adjustment leaves unknown of each frame (FrameError), from the Jacobian of its residuals over their standard
/// deviations at its end. Columns: turn and centre of each of the `poses` (6), `shared` parameters of which the lens
/// (3) is first, each of the `points` (3), then further points (3 each). Points are eliminated (Schur complement), what
/// remains is factored by sparse Cholesky, and each frame's part of its inverse comes out of one triangle. With
/// `ground_of_points` the ground below a frame is the plane through the points that it sees, and shares their error;
/// else it is given, and its rows are 0. The same digits for any number of threads. Throws DataError when the frames
/// are not determined, Interrupted.
std::vector<FrameError> frame_errors(const ceres::CRSMatrix& jacobian, int shared, const std::vector<FramePose>& poses,
                                     const std::vector<AdjustedPoint>& points, bool ground_of_points, int threads,
                                     const Progress& progress);

}  // namespace pilotage
