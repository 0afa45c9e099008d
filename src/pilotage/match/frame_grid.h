#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "pilotage/camera/ortho_rectify.h"
#include "pilotage/match/checkpoint.h"
#include "pilotage/vision/feature_options.h"
#include "pilotage/vision/feature_set.h"

namespace pilotage {

/// A rectified frame described everywhere instead of at its corners: descriptors on a grid of every `step_px` pixels.
/// A map feature can then be looked for wherever it may lie, and nothing depends on a detector finding the same corner
/// twice a year apart (docs/methods/match.md has what that is worth).
struct FrameGrid {
  static constexpr int kUsualStepPx = 2;

  int step_px = kUsualStepPx;
  int columns = 0;
  int rows = 0;
  std::vector<std::int32_t> index;  ///< Of the point in column c, row r: index[r · columns + c]; −1 where none can be.
  FeatureSet points;                ///< x_px, y_px in pixels of the rectified frame.

  /// Index of the point in a column and row, or −1.
  std::int32_t at(int column, int row) const {
    if (column < 0 || row < 0 || column >= columns || row >= rows) return -1;
    return index[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column)];
  }
};

/// Describes `frame` at every `step_px`-th pixel that lies kLeastInsidePx within the valid ones (or the descriptor's
/// reach, where that is less). What a patch needs beyond them is continued by the nearest valid pixel: a part of its
/// bits then says nothing, and the others still do (docs/methods/match.md has what it is worth). Of `options`, pattern
/// and descriptor_bits count. Throws UsageError for options out of range.
FrameGrid describe_frame_grid(const RectifiedFrame& frame, const FeatureOptions& options,
                              int step_px = FrameGrid::kUsualStepPx, const Checkpoint& checkpoint = {});

/// The same of a frame that has been continued already.
FrameGrid describe_continued_grid(const RectifiedFrame& frame, const FeatureOptions& options, int step_px,
                                  const Checkpoint& checkpoint = {});

/// The frame with as much more on each side as descriptors of these options may ask for, its pixels that are not valid
/// continued. What is valid stays.
RectifiedFrame continued_frame(const RectifiedFrame& frame, const FeatureOptions& options);

inline constexpr int kLeastInsidePx = 5;

}  // namespace pilotage
