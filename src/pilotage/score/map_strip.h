#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pilotage/base/progress.h"
#include "pilotage/geo/tile_matrix.h"
#include "pilotage/raster/gray_source.h"

namespace pilotage {

/// Where a window of a grid lies in an image of another window around it.
cv::Rect rect_in(const PixelWindow& outer, const PixelWindow& part);

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
  /// `centred` taken apart for a BlockCorrelator of this lag_step (take_apart). Empty when that is 1.
  int lag_step = 1;
  std::vector<cv::Mat> components;

  /// The part of an image of this strip that belongs to a window of the grid inside it.
  cv::Mat view(const cv::Mat& image, const PixelWindow& part) const;
  /// `centred` over any window; 0 beyond the strip. A view where that is possible.
  cv::Mat centred_window(const PixelWindow& part) const;
  /// The same taken apart for a BlockCorrelator, which has this strip's lag_step or 1.
  std::vector<cv::Mat> components_of(const PixelWindow& part, int correlator_lag_step) const;
  std::int64_t count_valid(const PixelWindow& part) const;
};

/// What a fixed sparse sample of the map (at most 64 windows of 32 × 32 px) says of all of it.
struct MapSample {
  /// A gray value near the mean; whole for integer imagery. Correlation does not depend on it, its rounding errors do.
  double center = 0;
  /// Correlation of pixels one (two) columns and rows apart, the smaller of both diagonals: near 1 on smooth ground, 0
  /// where each pixel is noise of its own. 0 when the sample has no contrast.
  double diagonal_correlation_1px = 0;
  double diagonal_correlation_2px = 0;
};
/// The same for any number of threads (0 = all cores). Throws what the source throws; Interrupted.
MapSample sample_map(const GraySource& source, int threads = 0, const Progress& progress = {});

/// CV_64F integral images of `centred` and of its squares.
struct StripIntegrals {
  cv::Mat sums;
  cv::Mat squares;
};

/// Reads a window of the source, in parallel. `previous`, if not null, is another strip of the same columns whose rows
/// are not read again. With a lag_step, window_sum and inverse_norm of windows of `tile_size_px` and the components are
/// computed; 0 when no surfaces are asked for. `strip` gets the result, `integrals` serve on the way; its images are
/// written over where their size fits: fresh memory costs as much time as what is put into it.
void load_strip(const GraySource& source, const PixelWindow& window, double center, int tile_size_px, int lag_step,
                const MapStrip* previous, int threads, StripIntegrals& integrals, MapStrip& strip);

}  // namespace pilotage
