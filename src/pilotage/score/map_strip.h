#pragma once

#include <cstdint>

#include <opencv2/core/mat.hpp>

#include "pilotage/geo/tile_matrix.h"
#include "pilotage/raster/gray_source.h"

namespace pilotage {

/// A rectangle of the map in memory, with what scoring needs of each pixel. Grid positions are those of the GraySource.
struct MapStrip {
  PixelWindow window;
  cv::Mat pixels;       ///< Gray values as read.
  cv::Mat valid;        ///< CV_8U, 255 where there is ground and the value is finite.
  cv::Mat centred;      ///< CV_32F: gray value minus the centre, 0 where not valid.
  cv::Mat valid_count;  ///< CV_32S integral image of the valid pixels.
  /// CV_32F, for each position of a tile-sized window (by its first pixel): the sum of `centred`, and 1/sqrt(Σ (f −
  /// f̄)²), 0 where the window is flat. Only meaningful where all pixels are valid. Empty unless asked for.
  cv::Mat window_sum;
  cv::Mat inverse_norm;

  /// The part of an image of this strip that belongs to a window of the grid inside it.
  cv::Mat view(const cv::Mat& image, const PixelWindow& part) const;
  /// `centred` over any window; 0 beyond the strip. A view where that is possible.
  cv::Mat centred_window(const PixelWindow& part) const;
  std::int64_t count_valid(const PixelWindow& part) const;
};

/// A gray value near the mean of the map, from a fixed sparse sample of it (at most 64 windows of 32 × 32 px); whole
/// for integer imagery. Correlation does not depend on it, its rounding errors do.
double sample_center(const GraySource& source);

/// Reads a window of the source, in parallel. `previous`, if not null, is a strip of the same columns whose rows are
/// not read again. `norms` asks for window_sum and inverse_norm of windows of `tile_size_px`.
MapStrip load_strip(const GraySource& source, const PixelWindow& window, double center, int tile_size_px, bool norms,
                    const MapStrip* previous, int threads);

}  // namespace pilotage
