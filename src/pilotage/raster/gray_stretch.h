#pragma once

#include <opencv2/core/mat.hpp>

#include "pilotage/raster/gray_source.h"

namespace pilotage {

/// Gray values low … high become 0 … 255.
struct GrayStretch {
  double low = 0;
  double high = 1;
};

/// The values below which `low_percent` and `high_percent` of the valid pixels lie (nearest rank), from a fixed sample
/// of the source: up to 16 × 16 windows of 64 × 64 pixels spread evenly over it. Low < high always (a flat source gives
/// [value, value + 1], a source without valid pixels [0, 1]). Throws UsageError unless 0 ≤ low < high ≤ 100.
GrayStretch find_stretch(const GraySource& source, double low_percent = 0.5, double high_percent = 99.5);

/// round(255 · (v − low) / (high − low)), held to 0 … 255; NaN becomes 0. One channel of any depth → CV_8U.
cv::Mat apply_stretch(const cv::Mat& pixels, const GrayStretch& stretch);

/// The source in 8 bits, for features and display: unchanged when it is CV_8U, else stretched by find_stretch. The
/// sample is read once, here; windows are stretched as they are read.
GraySource stretch_to_8bit(const GraySource& source, double low_percent = 0.5, double high_percent = 99.5);

/// The same by a stretch that is known.
GraySource stretch_to_8bit(const GraySource& source, const GrayStretch& stretch);

/// Share of the pixels of a window that are valid, 0 … 1; reads the window.
double valid_fraction(const GraySource& source, const PixelWindow& window);

/// Share of the pixels of a mask that are not 0; 0 for an empty mask.
double valid_fraction(const cv::Mat& valid);

}  // namespace pilotage
