#pragma once

#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pilotage/match/chip_search.h"

namespace pilotage {

/// Whole pixels about the nadir point: pixel (c, r) of a canvas covers c + left … c + left + 1 pixels right of it.
struct Canvas {
  int left = 0;
  int top = 0;
  int width = 0;
  int height = 0;
};

/// The frame under some hypotheses, over the pixels that all of them show.
struct ChipTemplates {
  Canvas canvas;
  cv::Mat mask;            ///< CV_8UC1: 255 where compared.
  std::vector<cv::Mat> z;  ///< CV_32FC2 of the mask's size, one for each hypothesis.
};

/// Nothing when no pixel is shown by all. At least one hypothesis; yaws finite, scales in [0.5, 2].
std::optional<ChipTemplates> make_chip_templates(const ChipFrame& frame, const std::vector<ChipHypothesis>& hypotheses);

}  // namespace pilotage
