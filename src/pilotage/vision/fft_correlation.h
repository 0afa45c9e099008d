#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace pilotage {

/// The smallest product of powers of 2, 3, 5 and 7 that is at least `size`: lengths FFTW has fast code for.
int fast_fft_size(int size);

/// Floats on a 64-byte boundary, as vector code likes them; all zero at first.
class AlignedFloats {
 public:
  AlignedFloats() = default;
  explicit AlignedFloats(std::size_t size);
  float* data() { return data_.get(); }
  const float* data() const { return data_.get(); }
  std::size_t size() const { return size_; }

 private:
  struct Free {
    void operator()(float* pointer) const;
  };
  std::unique_ptr<float[], Free> data_;
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

  RealFft2d(int height, int width);

  int height() const { return height_; }
  int width() const { return width_; }
  /// Floats of a spectrum. Its order is private to this class: strips of eight columns, complex numbers interleaved.
  std::size_t spectrum_size() const;
  Workspace make_workspace() const;

  /// Transform of `pixels` (CV_32F, at most height × width) in the top left corner of a frame of zeros. `spectrum` has
  /// spectrum_size() floats on a 64-byte boundary.
  void forward(const cv::Mat& pixels, Workspace& workspace, float* spectrum) const;

  /// Rows `rows` of the circular cross-correlation Σ_u a(u)·b(u + lag), times height · width, given to
  /// `sink(lag_row, values)` with `width` values each, in order.
  void correlate(const float* spectrum_a, const float* spectrum_b, const cv::Range& rows, Workspace& workspace,
                 const std::function<void(int, const float*)>& sink) const;

 private:
  struct Plans;
  int height_;
  int width_;
  std::size_t pitch_;  // complex numbers of a row of spectra, a multiple of 8
  std::shared_ptr<const Plans> plans_;
};

/// Correlation of many overlapping blocks of one map with their surroundings, all lags −radius … radius in rows and
/// columns, with the transforms of the map shared between blocks.
///
/// The lags of a block at p fall into windows_per_side² parts. Part (a, b) needs the map window of window_px² pixels at
/// p + (b, a)·hop − radius (overlap-save). When hop is a multiple of the stride between blocks, the windows of one
/// block are the windows of others too, and each is transformed once. The transform of a block and the inverses of the
/// parts are what remains per block. How many parts are cheapest follows from the sizes alone.
class BlockCorrelator {
 public:
  BlockCorrelator(int block_px, int radius_px, int stride_px);

  int block_px() const { return block_px_; }
  int radius_px() const { return radius_px_; }
  int windows_per_side() const { return windows_per_side_; }
  int hop_px() const { return hop_px_; }
  /// Pixels of a map window that matter; the rest of the transform's frame is zero.
  int window_px() const { return hop_px_ + block_px_; }
  std::size_t spectrum_size() const { return fft_.spectrum_size(); }
  RealFft2d::Workspace make_workspace() const { return fft_.make_workspace(); }

  /// Transform of a block (block_px²) or a map window (window_px²), CV_32F.
  void forward(const cv::Mat& pixels, RealFft2d::Workspace& workspace, float* spectrum) const {
    fft_.forward(pixels, workspace, spectrum);
  }

  /// `surface` (CV_32F, (2·radius + 1)², allocated by the caller) becomes Σ_u block(u)·map(u + lag) · scale(), where
  /// element (radius, radius) is lag 0; only its rows `rows` are computed. `windows` are the spectra of parts (0,0),
  /// (0,1) …, row by row; those of parts without such rows are not looked at.
  void correlate(const float* block, std::span<const float* const> windows, const cv::Range& rows,
                 RealFft2d::Workspace& workspace, cv::Mat& surface) const;
  /// Multiply surfaces by 1/scale() to get sums of products.
  double scale() const { return static_cast<double>(fft_.height()) * fft_.width(); }

 private:
  int block_px_;
  int radius_px_;
  int windows_per_side_;
  int hop_px_;
  RealFft2d fft_;
};

/// Zero-mean normalised cross-correlation of `tile` at every position of `region` where it lies inside, as
/// cv::TM_CCOEFF_NORMED: CV_32F of (region − tile + 1). A position whose window is flat, or any when the tile is, gets
/// 0. Inputs CV_32F. Error below 1e-4 where the window's standard deviation is at least 1/50 of the region's. Throws
/// UsageError when the tile is larger than the region.
cv::Mat correlation_surface(const cv::Mat& tile, const cv::Mat& region);

/// The same over the pixels that are valid in both (masks CV_8U, 0 = no ground): masked normalised cross-correlation,
/// D. Padfield, "Masked object registration in the Fourier domain", IEEE Trans. Image Processing 21(5), 2012, eq. 9.
/// Positions that overlap less than `min_overlap` of the tile's valid pixels are NaN. Windows whose variance over the
/// overlap is below 1e-5 of the largest one count as flat and get 0. Error below 1e-3 where the variance is at least
/// 1/100 of the largest. Where everything is valid it is correlation_surface().
cv::Mat masked_correlation_surface(const cv::Mat& tile, const cv::Mat& tile_valid, const cv::Mat& region,
                                   const cv::Mat& region_valid, double min_overlap);

}  // namespace pilotage
