#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace pilotage {

/// The smallest product of powers of 2, 3 and 5 that is at least `size`: lengths FFTW is fast at.
int fast_fft_size(int size);

/// Floats on a 64-byte boundary, as vector code likes them; all zero at first. Large arrays take memory only where
/// something was written, and give it back to the system.
class AlignedFloats {
 public:
  AlignedFloats() = default;
  explicit AlignedFloats(std::size_t size);
  float* data() { return data_; }
  const float* data() const { return data_; }
  std::size_t size() const { return size_; }

 private:
  struct Free {
    void operator()(void* pointer) const;
  };
  std::unique_ptr<void, Free> memory_;
  float* data_ = nullptr;
  std::size_t size_ = 0;
};

/// Real two-dimensional transforms of one size in single precision (FFTW 3), for correlation: transforms of images that
/// fill only part of the frame skip the empty rows, and the inverse yields only the rows that are asked for.
///
/// Plans are made once, with FFTW_ESTIMATE, so the same machine computes the same bytes in every run. Objects may be
/// copied and used by several threads at a time, each with its own Workspace.
class RealFft2d {
 public:
  /// Scratch space of one thread.
  struct Workspace {
    AlignedFloats rows;   // row spectra, height × pitch complex
    AlignedFloats strip;  // eight columns
    AlignedFloats line;   // one row of pixels
  };

  /// `terms` images of this size are transformed and correlated together: their spectra stand side by side in memory.
  RealFft2d(int height, int width, int terms = 1);

  int height() const { return height_; }
  int width() const { return width_; }
  /// Floats of the spectra of all terms. Their order is private to this class: strips of eight columns of each term in
  /// turn, complex numbers interleaved.
  std::size_t spectrum_size() const;
  Workspace make_workspace() const;

  /// Transform of `pixels` (CV_32F, at most height × width) in the top left corner of a frame of zeros. `spectrum` has
  /// spectrum_size() floats on a 64-byte boundary, of which those of `term` are written.
  void forward(const cv::Mat& pixels, Workspace& workspace, float* spectrum, int term = 0) const;

  /// Rows `rows` of the circular cross-correlations Σ_u a(u)·b(u + lag) of each of `spectra_a`, summed over the terms,
  /// times height · width, given to `sink(index of a, lag_row, values)` with `width` values each, in order. One
  /// workspace for each. Several at a time read `spectrum_b` from memory once.
  void correlate(std::span<const float* const> spectra_a, const float* spectrum_b, const cv::Range& rows,
                 std::span<Workspace> workspaces,
                 const std::function<void(std::size_t, int, const float*)>& sink) const;

 private:
  struct Plans;
  int height_;
  int width_;
  std::size_t terms_;
  std::size_t pitch_;  // complex numbers of a row of spectra, a multiple of 8
  std::shared_ptr<const Plans> plans_;
};

/// components[step·i + j] becomes the pixels (step·v + i, step·w + j) of a CV_32F image; step is 1, 2 or 4.
void take_apart(const cv::Mat& image, int step, std::vector<cv::Mat>& components);

/// Correlation of many overlapping blocks of one map with their surroundings at the lags k·lag_step (k whole numbers in
/// rows and columns) up to the radius, with the transforms of the map shared between blocks.
///
/// With lag_step s, block and map are split into s × s components (take_apart), from the first pixel of the block or
/// window. The correlation at lag s·k is the sum over the components of their
/// correlations at lag k, so transforms are s times shorter either way, and as few as there are lags to compute.
///
/// The lags of a block at p fall into windows_per_side² parts. Part (a, b) needs the map window of window_px² pixels at
/// p + (b, a)·hop_px − radius_px (overlap-save). When hop_px is a multiple of the stride between blocks, the windows of
/// one block are the windows of others too, and each is transformed once. The transform of a block and the inverses of
/// the parts are what remains per block. How many parts are cheapest follows from the sizes alone.
class BlockCorrelator {
 public:
  /// Throws UsageError unless lag_step is 1, 2 or 4.
  BlockCorrelator(int block_px, int radius_px, int stride_px, int lag_step = 1);

  int block_px() const { return block_px_; }
  int lag_step() const { return lag_step_; }
  /// Lags to each side; the farthest is radius()·lag_step pixels away.
  int radius() const { return radius_; }
  int radius_px() const { return radius_ * lag_step_; }
  int windows_per_side() const { return windows_per_side_; }
  int hop_px() const { return hop_ * lag_step_; }
  /// Pixels of a map window that matter; the rest of the transform's frame is zero.
  int window_px() const { return (hop_ + (block_px_ + lag_step_ - 1) / lag_step_) * lag_step_; }
  /// Floats of the spectra of a block or a window, all components.
  std::size_t spectrum_size() const { return fft_.spectrum_size(); }
  RealFft2d::Workspace make_workspace() const { return fft_.make_workspace(); }

  /// Transforms of the components of a block (block_px²) or a map window (window_px²), CV_32F, in the order (0,0),
  /// (0,1) ….
  void forward(std::span<const cv::Mat> components, RealFft2d::Workspace& workspace, float* spectra) const;

  /// Each of `surfaces` (CV_32F, (2·radius() + 1)², allocated by the caller) becomes Σ_u block(u)·map(u + lag) ·
  /// scale() of one of `blocks`, which all stand at the same place, where element (radius(), radius()) is lag 0 and
  /// neighbours are lag_step pixels apart; only rows `rows` are computed. `windows` are the spectra of parts (0,0),
  /// (0,1) …, row by row; those of parts without such rows are not looked at. One workspace for each block.
  void correlate(std::span<const float* const> blocks, std::span<const float* const> windows, const cv::Range& rows,
                 std::span<RealFft2d::Workspace> workspaces, std::span<cv::Mat> surfaces) const;
  /// Multiply surfaces by 1/scale() to get sums of products.
  double scale() const { return static_cast<double>(fft_.height()) * fft_.width(); }

 private:
  int block_px_;
  int lag_step_;
  int radius_;  // lags
  int windows_per_side_;
  int hop_;  // lags
  RealFft2d fft_;
};

/// Zero-mean normalised cross-correlation of `tile` at every position of `region` where it lies inside, as
/// cv::TM_CCOEFF_NORMED: CV_32F of (region − tile + 1). A position whose window is flat, or any when the tile is, gets
/// 0. Inputs CV_32F. Error below 1e-4 where the window's standard deviation is at least 1/50 of the region's. Throws
/// UsageError when the tile is larger than the region.
cv::Mat correlation_surface(const cv::Mat& tile, const cv::Mat& region);

/// Surfaces of tiles that share the mask `tile_valid`, over the pixels valid in both: MaskedCorrelation by FFTW's
/// transforms, NaN where it compares nothing. What it returns takes a tile (CV_32F) and serves one thread at a time.
/// Throws UsageError when the tile is larger than the region, or a mask is not CV_8U and as large as its image.
std::function<cv::Mat(const cv::Mat& tile)> masked_surfaces(const cv::Mat& tile_valid, const cv::Mat& region,
                                                            const cv::Mat& region_valid, double min_overlap);

/// The surface of one tile. Where everything is valid it is correlation_surface().
cv::Mat masked_correlation_surface(const cv::Mat& tile, const cv::Mat& tile_valid, const cv::Mat& region,
                                   const cv::Mat& region_valid, double min_overlap);

}  // namespace pilotage
