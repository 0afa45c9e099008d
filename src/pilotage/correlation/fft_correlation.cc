#include "pilotage/correlation/fft_correlation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <mutex>
#include <new>
#include <string>

#include <fftw3.h>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"
#include "pilotage/correlation/correlation_kernels.h"
#include "pilotage/vision/masked_correlation.h"

namespace pilotage {
namespace {

constexpr int kStrip = 8;  // columns transformed together: 64 bytes
constexpr std::size_t kAlignment = 64;

/// FFTW's planner, unlike its execution, must not run in two threads at a time.
std::mutex& planner_mutex() {
  static std::mutex mutex;
  return mutex;
}

fftwf_complex* as_complex(float* pointer) {
  return reinterpret_cast<fftwf_complex*>(pointer);
}

/// Work of one block, in transforms of one frame: its own, its share of the map's windows, and the inverses, of which
/// one serves all components. An inverse also reads spectra that are no longer in the cache; 1.4 sets the measured
/// order of 1, 2 and 4 windows a side right.
double cost(int block, int radius, int components, int windows_per_side) {
  const double size = fast_fft_size(2 * radius / windows_per_side + block);
  return (2 * components + 1.4 * windows_per_side * windows_per_side) * size * size * std::log2(size);
}

/// Block and radius in steps of the lags, the stride in pixels.
int choose_windows_per_side(int block, int radius, int stride_px, int lag_step) {
  int best = 1;
  for (const int windows : {2, 4}) {
    const bool shared = radius > 0 && 2 * radius % windows == 0 && 2 * radius * lag_step % (windows * stride_px) == 0;
    const int components = lag_step * lag_step;
    if (shared && cost(block, radius, components, windows) < cost(block, radius, components, best)) best = windows;
  }
  return best;
}

int checked_lag_step(int lag_step) {
  if (lag_step != 1 && lag_step != 2 && lag_step != 4) {
    throw UsageError("lag_step = " + std::to_string(lag_step) + " is not 1, 2 or 4");
  }
  return lag_step;
}

/// Every step-th number of a row, from the first.
template <int step>
void take_every(const float* values, int count, float* out) {
  for (int i = 0; i < count; ++i) out[i] = values[step * i];
}

/// Checks both; the size of the surface.
cv::Size positions_of(const cv::Size& tile, const cv::Mat& region) {
  if (region.type() != CV_32FC1) throw UsageError("correlation needs CV_32F images");
  if (tile.empty() || tile.width > region.cols || tile.height > region.rows) {
    throw UsageError("correlation: a tile of " + std::to_string(tile.width) + " x " + std::to_string(tile.height) +
                     " px does not fit into a region of " + std::to_string(region.cols) + " x " +
                     std::to_string(region.rows) + " px");
  }
  return {region.cols - tile.width + 1, region.rows - tile.height + 1};
}

/// By FFTW, of templates of a size and a region.
SumsOfProducts fftw_sums_of_products(const cv::Size& tile, const cv::Mat& region) {
  struct Engine {
    RealFft2d fft;
    RealFft2d::Workspace workspace;
  };
  const cv::Size size = positions_of(tile, region);
  const RealFft2d fft(fast_fft_size(region.rows), fast_fft_size(region.cols));
  const auto engine = std::make_shared<Engine>(Engine{fft, fft.make_workspace()});
  const auto spectrum = [engine](const cv::Mat& pixels) {
    cv::Mat result(1, static_cast<int>(engine->fft.spectrum_size()), CV_32F);
    engine->fft.forward(pixels, engine->workspace, result.ptr<float>());
    return result;
  };
  const auto correlate = [engine, size](const cv::Mat& template_spectrum, const cv::Mat& region_spectrum) {
    cv::Mat result(size, CV_32F);
    const RealFft2d& transform = engine->fft;
    const auto scale = static_cast<float>(1.0 / (static_cast<double>(transform.height()) * transform.width()));
    const std::array<const float*, 1> spectra{template_spectrum.ptr<float>()};
    transform.correlate(spectra, region_spectrum.ptr<float>(), {0, size.height}, {&engine->workspace, 1},
                        [&](std::size_t, int row, const float* values) {
                          float* line = result.ptr<float>(row);
                          for (int col = 0; col < size.width; ++col) line[col] = values[col] * scale;
                        });
    return result;
  };
  return {spectrum, correlate};
}

}  // namespace

int fast_fft_size(int size) {
  for (int candidate = std::max(1, size);; ++candidate) {
    int rest = candidate;
    for (const int factor : {2, 3, 5}) {
      while (rest % factor == 0) rest /= factor;
    }
    if (rest == 1) return candidate;
  }
}

AlignedFloats::AlignedFloats(std::size_t size)
    : memory_(std::calloc(size * sizeof(float) + kAlignment, 1)), size_(size) {
  if (memory_ == nullptr) throw std::bad_alloc();
  void* aligned = memory_.get();
  std::size_t space = size * sizeof(float) + kAlignment;
  data_ = static_cast<float*>(std::align(kAlignment, size * sizeof(float), aligned, space));
}

void AlignedFloats::Free::operator()(void* pointer) const {
  std::free(pointer);
}

struct RealFft2d::Plans {
  fftwf_plan rows = nullptr;             // one row, real → complex
  fftwf_plan columns = nullptr;          // eight columns of the row spectra → a strip
  fftwf_plan inverse_columns = nullptr;  // a strip → eight columns
  fftwf_plan inverse_rows = nullptr;

  Plans(int height, int width, std::size_t pitch, Workspace workspace) {
    const std::lock_guard lock(planner_mutex());
    const int n = height;
    const auto stride = static_cast<int>(pitch);
    float* line = workspace.line.data();
    fftwf_complex* spectra = as_complex(workspace.rows.data());
    fftwf_complex* strip = as_complex(workspace.strip.data());
    rows = fftwf_plan_dft_r2c_1d(width, line, spectra, FFTW_ESTIMATE);
    columns = fftwf_plan_many_dft(1, &n, kStrip, spectra, nullptr, stride, 1, strip, nullptr, kStrip, 1, FFTW_FORWARD,
                                  FFTW_ESTIMATE);
    inverse_columns = fftwf_plan_many_dft(1, &n, kStrip, strip, nullptr, kStrip, 1, spectra, nullptr, stride, 1,
                                          FFTW_BACKWARD, FFTW_ESTIMATE);
    inverse_rows = fftwf_plan_dft_c2r_1d(width, spectra, line, FFTW_ESTIMATE);
    if (rows == nullptr || columns == nullptr || inverse_columns == nullptr || inverse_rows == nullptr) {
      throw DataError("FFTW cannot plan a transform of " + std::to_string(width) + " x " + std::to_string(height));
    }
  }
  ~Plans() {
    const std::lock_guard lock(planner_mutex());
    for (const fftwf_plan plan : {rows, columns, inverse_columns, inverse_rows}) {
      if (plan != nullptr) fftwf_destroy_plan(plan);
    }
  }
  Plans(const Plans&) = delete;
  Plans& operator=(const Plans&) = delete;
};

RealFft2d::RealFft2d(int height, int width, int terms)
    : height_(height),
      width_(width),
      terms_(static_cast<std::size_t>(terms)),
      pitch_(static_cast<std::size_t>(width / 2 + 1 + kStrip - 1) / kStrip * kStrip),
      plans_(std::make_shared<const Plans>(height, width, pitch_, make_workspace())) {}

std::size_t RealFft2d::spectrum_size() const {
  return 2 * pitch_ * static_cast<std::size_t>(height_) * terms_;
}

RealFft2d::Workspace RealFft2d::make_workspace() const {
  return {AlignedFloats(2 * pitch_ * static_cast<std::size_t>(height_)),
          AlignedFloats(static_cast<std::size_t>(height_) * kStrip * 2),
          AlignedFloats((static_cast<std::size_t>(width_) + 15) / 16 * 16)};
}

void RealFft2d::forward(const cv::Mat& pixels, Workspace& workspace, float* spectrum, int term) const {
  float* line = workspace.line.data();
  float* rows = workspace.rows.data();
  std::fill(line + pixels.cols, line + width_, 0.0F);
  for (int row = 0; row < pixels.rows; ++row) {
    std::memcpy(line, pixels.ptr<float>(row), static_cast<std::size_t>(pixels.cols) * sizeof(float));
    fftwf_execute_dft_r2c(plans_->rows, line, as_complex(rows + 2 * pitch_ * static_cast<std::size_t>(row)));
  }
  std::fill(rows + 2 * pitch_ * static_cast<std::size_t>(pixels.rows), rows + workspace.rows.size(), 0.0F);
  const std::size_t strip_size = static_cast<std::size_t>(height_) * kStrip * 2;
  float* out = spectrum + static_cast<std::size_t>(term) * strip_size;
  for (std::size_t strip = 0; strip < pitch_ / kStrip; ++strip) {
    fftwf_execute_dft(plans_->columns, as_complex(rows + strip * kStrip * 2),
                      as_complex(out + strip * terms_ * strip_size));
  }
}

void RealFft2d::correlate(std::span<const float* const> spectra_a, const float* spectrum_b, const cv::Range& rows,
                          std::span<Workspace> workspaces,
                          const std::function<void(std::size_t, int, const float*)>& sink) const {
  const std::size_t strip_size = static_cast<std::size_t>(height_) * kStrip * 2;
  for (std::size_t strip = 0; strip < pitch_ / kStrip; ++strip) {
    const std::size_t first = strip * terms_ * strip_size;
    for (std::size_t i = 0; i < spectra_a.size(); ++i) {
      float* product = workspaces[i].strip.data();
      multiply_conjugate_sum(spectra_a[i] + first, spectrum_b + first, terms_, strip_size / 2, product);
      fftwf_execute_dft(plans_->inverse_columns, as_complex(product),
                        as_complex(workspaces[i].rows.data() + strip * kStrip * 2));
    }
  }
  for (std::size_t i = 0; i < spectra_a.size(); ++i) {
    float* line = workspaces[i].line.data();
    for (int row = rows.start; row < rows.end; ++row) {
      float* spectrum = workspaces[i].rows.data() + 2 * pitch_ * static_cast<std::size_t>(row);
      fftwf_execute_dft_c2r(plans_->inverse_rows, as_complex(spectrum), line);
      sink(i, row, line);
    }
  }
}

void take_apart(const cv::Mat& image, int step, std::vector<cv::Mat>& components) {
  checked_lag_step(step);
  components.resize(static_cast<std::size_t>(step) * static_cast<std::size_t>(step));
  for (int i = 0; i < step; ++i) {
    for (int j = 0; j < step; ++j) {
      cv::Mat& component = components[static_cast<std::size_t>(step * i + j)];
      component.create((image.rows + step - 1 - i) / step, (image.cols + step - 1 - j) / step, CV_32F);
      for (int row = 0; row < component.rows; ++row) {
        const float* values = image.ptr<float>(step * row + i) + j;
        float* out = component.ptr<float>(row);
        if (step == 2) {
          take_every<2>(values, component.cols, out);
        } else if (step == 4) {
          take_every<4>(values, component.cols, out);
        } else {
          std::memcpy(out, values, static_cast<std::size_t>(component.cols) * sizeof(float));
        }
      }
    }
  }
}

BlockCorrelator::BlockCorrelator(int block_px, int radius_px, int stride_px, int lag_step)
    : block_px_(block_px),
      lag_step_(checked_lag_step(lag_step)),
      radius_(radius_px / lag_step_),
      windows_per_side_(choose_windows_per_side((block_px + lag_step_ - 1) / lag_step_, radius_, stride_px, lag_step_)),
      hop_(2 * radius_ / windows_per_side_),
      fft_(fast_fft_size(window_px() / lag_step_), fast_fft_size(window_px() / lag_step_), lag_step_ * lag_step_) {}

void BlockCorrelator::forward(std::span<const cv::Mat> components, RealFft2d::Workspace& workspace,
                              float* spectra) const {
  for (std::size_t i = 0; i < components.size(); ++i) {
    fft_.forward(components[i], workspace, spectra, static_cast<int>(i));
  }
}

void BlockCorrelator::correlate(std::span<const float* const> blocks, std::span<const float* const> windows,
                                const cv::Range& rows, std::span<RealFft2d::Workspace> workspaces,
                                std::span<cv::Mat> surfaces) const {
  // Part k covers lags k·hop … k·hop + hop − 1 above −radius; the last one has lag +radius too.
  const auto lags = [&](int part) { return hop_ + (part + 1 == windows_per_side_ ? 1 : 0); };
  for (int part_row = 0; part_row < windows_per_side_; ++part_row) {
    const int first = part_row * hop_;
    const cv::Range wanted(std::max(rows.start - first, 0), std::min(rows.end - first, lags(part_row)));
    if (wanted.start >= wanted.end) continue;
    for (int part_col = 0; part_col < windows_per_side_; ++part_col) {
      const auto part = static_cast<std::size_t>(part_row * windows_per_side_ + part_col);
      const std::size_t bytes = static_cast<std::size_t>(lags(part_col)) * sizeof(float);
      fft_.correlate(blocks, windows[part], wanted, workspaces, [&](std::size_t block, int row, const float* values) {
        std::memcpy(surfaces[block].ptr<float>(first + row) + part_col * hop_, values, bytes);
      });
    }
  }
}

cv::Mat correlation_surface(const cv::Mat& tile, const cv::Mat& region) {
  if (tile.type() != CV_32FC1) throw UsageError("correlation needs CV_32F images");
  const cv::Size size = positions_of(tile.size(), region);
  // Both lose the tile's mean, which changes no result and keeps the sums small.
  const double mean = cv::mean(tile)[0];
  const cv::Mat zero_mean_tile = tile - mean;
  const cv::Mat centred = region - mean;
  const SumsOfProducts products = fftw_sums_of_products(tile.size(), region);
  cv::Mat surface = products.correlate(products.spectrum(zero_mean_tile), products.spectrum(centred));
  cv::Mat sums;
  cv::Mat squares;
  cv::integral(centred, sums, squares, CV_64F, CV_64F);
  const double count = static_cast<double>(tile.total());
  const double tile_norm = cv::norm(zero_mean_tile, cv::NORM_L2SQR);
  const double energy = squares.at<double>(region.rows, region.cols);
  for (int row = 0; row < size.height; ++row) {
    for (int col = 0; col < size.width; ++col) {
      const auto over_window = [&](const cv::Mat& integral) {
        return integral.at<double>(row + tile.rows, col + tile.cols) - integral.at<double>(row, col + tile.cols) -
               integral.at<double>(row + tile.rows, col) + integral.at<double>(row, col);
      };
      const double sum = over_window(sums);
      const double norm = over_window(squares) - sum * sum / count;
      float& value = surface.at<float>(row, col);
      const bool flat = tile_norm <= 0 || norm <= 1e-12 * energy;
      value = flat
                  ? 0.0F
                  : static_cast<float>(std::clamp(static_cast<double>(value) / std::sqrt(tile_norm * norm), -1.0, 1.0));
    }
  }
  return surface;
}

std::function<cv::Mat(const cv::Mat& tile)> masked_surfaces(const cv::Mat& tile_valid, const cv::Mat& region,
                                                            const cv::Mat& region_valid, double min_overlap) {
  if (tile_valid.type() != CV_8UC1 || region_valid.type() != CV_8UC1 || region_valid.size() != region.size()) {
    throw UsageError("masked correlation: masks must be CV_8U and as large as their images");
  }
  const auto correlation = std::make_shared<const MaskedCorrelation>(tile_valid, region, region_valid, min_overlap, 0,
                                                                     fftw_sums_of_products(tile_valid.size(), region));
  return [correlation](const cv::Mat& tile) {
    cv::Mat surface = correlation->surface(tile);
    surface.setTo(std::numeric_limits<float>::quiet_NaN(), surface == MaskedCorrelation::kNotCompared);
    return surface;
  };
}

cv::Mat masked_correlation_surface(const cv::Mat& tile, const cv::Mat& tile_valid, const cv::Mat& region,
                                   const cv::Mat& region_valid, double min_overlap) {
  positions_of(tile.size(), region);
  if (tile.type() != CV_32FC1) throw UsageError("correlation needs CV_32F images");
  if (tile_valid.size() != tile.size()) {
    throw UsageError("masked correlation: masks must be CV_8U and as large as their images");
  }
  const auto all_valid = [](const cv::Mat& valid) { return cv::countNonZero(valid) == valid.rows * valid.cols; };
  if (all_valid(tile_valid) && all_valid(region_valid)) return correlation_surface(tile, region);
  return masked_surfaces(tile_valid, region, region_valid, min_overlap)(tile);
}

}  // namespace pilotage
