#pragma once

#include <array>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pilotage/capture/adjust_block.h"

namespace pilotage {

/// What brings the colours of a block's frames to each other: a pixel's value is divided by
/// exp(gain of the frame + a·r² + b·r⁴), r its distance from the middle of the picture over half the diagonal.
struct ColorBalance {
  std::vector<std::array<double, 3>> log_gain;     ///< Per frame; red, green, blue.
  std::array<std::array<double, 2>, 3> falloff{};  ///< a and b of the lens, per colour.
};

/// Least squares over the points that frames have in common, with Cauchy's weights; gains are 0 on average. `pictures`
/// are those of the block's frames.
ColorBalance balance_colors(const std::vector<FramePicture>& pictures, const AdjustedBlock& block);

}  // namespace pilotage
