#include "pilotage/score/map_strip.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include <opencv2/imgproc.hpp>

#include "pilotage/base/parallel.h"
#include "pilotage/correlation/fft_correlation.h"

namespace pilotage {
namespace {

constexpr int kBandRows = 64;  // rows converted by one piece of work

/// Marks pixels that are not finite as not valid.
void drop_not_finite(const cv::Mat& pixels, cv::Mat& valid) {
  for (int row = 0; row < pixels.rows; ++row) {
    std::uint8_t* mask = valid.ptr(row);
    for (int col = 0; col < pixels.cols; ++col) {
      const double value =
          pixels.depth() == CV_64F ? pixels.at<double>(row, col) : static_cast<double>(pixels.at<float>(row, col));
      if (!std::isfinite(value)) mask[col] = 0;
    }
  }
}

void read_band(const GraySource& source, const PixelWindow& band, cv::Mat pixels, cv::Mat valid) {
  const Raster raster = source.read(band);
  raster.pixels.copyTo(pixels);
  cv::compare(raster.valid, 0, valid, cv::CMP_NE);
  if (pixels.depth() == CV_32F || pixels.depth() == CV_64F) drop_not_finite(pixels, valid);
}

void center_band(const cv::Mat& pixels, const cv::Mat& valid, double center, cv::Mat centred) {
  cv::Mat values;
  pixels.convertTo(values, CV_32F, 1, -center);
  centred.setTo(0);
  values.copyTo(centred, valid);
}

/// Rows [first, last) of window_sum and inverse_norm.
void norm_rows(const StripIntegrals& integrals, int tile_size_px, int first, int last, MapStrip& strip) {
  const double count = static_cast<double>(tile_size_px) * tile_size_px;
  const int width = strip.window_sum.cols;
  for (int row = first; row < last; ++row) {
    const double* sum_top = integrals.sums.ptr<double>(row);
    const double* sum_bottom = integrals.sums.ptr<double>(row + tile_size_px);
    const double* square_top = integrals.squares.ptr<double>(row);
    const double* square_bottom = integrals.squares.ptr<double>(row + tile_size_px);
    float* sum_out = strip.window_sum.ptr<float>(row);
    float* norm_out = strip.inverse_norm.ptr<float>(row);
    for (int col = 0; col < width; ++col) {
      const int end = col + tile_size_px;
      const double sum = sum_bottom[end] - sum_bottom[col] - (sum_top[end] - sum_top[col]);
      const double square = square_bottom[end] - square_bottom[col] - (square_top[end] - square_top[col]);
      const double norm = square - sum * sum / count;
      sum_out[col] = static_cast<float>(sum);
      norm_out[col] = norm > 1e-12 * square && norm > 0 ? static_cast<float>(1 / std::sqrt(norm)) : 0.0F;
    }
  }
}

}  // namespace

cv::Rect rect_in(const PixelWindow& outer, const PixelWindow& part) {
  return {static_cast<int>(part.col - outer.col), static_cast<int>(part.row - outer.row), part.width, part.height};
}

cv::Mat MapStrip::view(const cv::Mat& image, const PixelWindow& part) const {
  return image(rect_in(window, part));
}

cv::Mat MapStrip::centred_window(const PixelWindow& part) const {
  const cv::Rect wanted = rect_in(window, part);
  const cv::Rect inside = wanted & cv::Rect(0, 0, window.width, window.height);
  if (inside == wanted) return centred(inside);
  cv::Mat result = cv::Mat::zeros(wanted.size(), CV_32F);
  if (!inside.empty()) centred(inside).copyTo(result(inside - wanted.tl()));
  return result;
}

std::int64_t MapStrip::count_valid(const PixelWindow& part) const {
  const cv::Rect rect = rect_in(window, part);
  const auto at = [&](int row, int col) { return valid_count.at<int>(row, col); };
  return at(rect.y + rect.height, rect.x + rect.width) - at(rect.y, rect.x + rect.width) -
         at(rect.y + rect.height, rect.x) + at(rect.y, rect.x);
}

std::vector<cv::Mat> MapStrip::components_of(const PixelWindow& part, int correlator_lag_step) const {
  if (correlator_lag_step == 1) return {centred_window(part)};
  const int step = correlator_lag_step;
  const cv::Rect rect = rect_in(window, part);
  std::vector<cv::Mat> result;
  if ((rect & cv::Rect(0, 0, window.width, window.height)) != rect) {
    take_apart(centred_window(part), step, result);
    return result;
  }
  for (int i = 0; i < step; ++i) {
    for (int j = 0; j < step; ++j) {
      const int row = rect.y + i;
      const int col = rect.x + j;
      const cv::Mat& component = components[static_cast<std::size_t>(step * (row % step) + col % step)];
      result.push_back(component(
          cv::Rect(col / step, row / step, (rect.width + step - 1 - j) / step, (rect.height + step - 1 - i) / step)));
    }
  }
  return result;
}

MapSample sample_map(const GraySource& source, int threads, const Progress& progress) {
  constexpr std::size_t kSamples = 8;
  constexpr std::int64_t kSide = 32;
  struct Window {
    cv::Mat pixels;
    cv::Mat valid;
  };
  const auto width = static_cast<int>(std::min(kSide, source.width_px));
  const auto height = static_cast<int>(std::min(kSide, source.height_px));
  std::vector<Window> windows(kSamples * kSamples);
  std::mutex mutex;
  parallel_for(windows.size(), threads, [&](std::size_t i, int) {
    const auto column = static_cast<std::int64_t>(i / kSamples);
    const auto row = static_cast<std::int64_t>(i % kSamples);
    const PixelWindow place{(source.width_px - width) * column / (std::int64_t{kSamples} - 1),
                            (source.height_px - height) * row / (std::int64_t{kSamples} - 1), width, height};
    windows[i] = {cv::Mat(height, width, source.depth), cv::Mat(height, width, CV_8U)};
    read_band(source, place, windows[i].pixels, windows[i].valid);
    const std::lock_guard lock(mutex);
    report_progress(progress, "score", 0, 0);
  });
  std::erase_if(windows, [](const Window& window) { return cv::countNonZero(window.valid) == 0; });
  double sum = 0;
  std::int64_t count = 0;
  for (const Window& window : windows) {
    const int n = cv::countNonZero(window.valid);
    sum += cv::mean(window.pixels, window.valid)[0] * n;
    count += n;
  }
  MapSample sample;
  if (count == 0) return sample;
  const double mean = sum / static_cast<double>(count);
  sample.center = source.depth == CV_8U || source.depth == CV_16U ? std::round(mean) : mean;
  const auto diagonal_correlation = [&](int distance) {
    double squares = 0;
    double falling = 0;
    double rising = 0;
    for (const Window& window : windows) {
      cv::Mat values(window.pixels.size(), CV_32F);
      center_band(window.pixels, window.valid, mean, values);
      const cv::Rect rest(0, 0, values.cols - distance, values.rows - distance);
      if (rest.width <= 0 || rest.height <= 0) continue;
      const cv::Mat top_left = values(rest);
      squares += top_left.dot(top_left);
      falling += top_left.dot(values(rest + cv::Point(distance, distance)));
      rising += values(rest + cv::Point(distance, 0)).dot(values(rest + cv::Point(0, distance)));
    }
    return squares > 0 ? std::min(falling, rising) / squares : 0.0;
  };
  sample.diagonal_correlation_1px = diagonal_correlation(1);
  sample.diagonal_correlation_2px = diagonal_correlation(2);
  return sample;
}

void load_strip(const GraySource& source, const PixelWindow& window, double center, int tile_size_px, int lag_step,
                const MapStrip* previous, int threads, StripIntegrals& integrals, MapStrip& strip) {
  strip.window = window;
  strip.pixels.create(window.height, window.width, source.depth);
  strip.valid.create(window.height, window.width, CV_8U);
  strip.centred.create(window.height, window.width, CV_32F);

  // Rows the previous strip has already.
  int known = 0;
  if (previous != nullptr && previous->window.col == window.col && previous->window.width == window.width &&
      previous->window.row <= window.row) {
    known = static_cast<int>(
        std::clamp<std::int64_t>(previous->window.row + previous->window.height - window.row, 0, window.height));
    const auto first = static_cast<int>(window.row - previous->window.row);
    if (known > 0) {
      previous->pixels.rowRange(first, first + known).copyTo(strip.pixels.rowRange(0, known));
      previous->valid.rowRange(first, first + known).copyTo(strip.valid.rowRange(0, known));
      previous->centred.rowRange(first, first + known).copyTo(strip.centred.rowRange(0, known));
    }
  }
  const int bands = (window.height - known + kBandRows - 1) / kBandRows;
  parallel_for(static_cast<std::size_t>(bands), threads, [&](std::size_t band, int) {
    const int first = known + static_cast<int>(band) * kBandRows;
    const int last = std::min(window.height, first + kBandRows);
    const PixelWindow part{window.col, window.row + first, window.width, last - first};
    read_band(source, part, strip.pixels.rowRange(first, last), strip.valid.rowRange(first, last));
    center_band(strip.pixels.rowRange(first, last), strip.valid.rowRange(first, last), center,
                strip.centred.rowRange(first, last));
  });

  cv::Mat ones;
  cv::bitwise_and(strip.valid, 1, ones);
  cv::integral(ones, strip.valid_count, CV_32S);
  if (lag_step == 0) return;
  strip.lag_step = lag_step;
  if (lag_step > 1) take_apart(strip.centred, lag_step, strip.components);
  cv::integral(strip.centred, integrals.sums, integrals.squares, CV_64F, CV_64F);
  const cv::Size positions(window.width - tile_size_px + 1, window.height - tile_size_px + 1);
  strip.window_sum.create(positions, CV_32F);
  strip.inverse_norm.create(positions, CV_32F);
  const int norm_bands = (positions.height + kBandRows - 1) / kBandRows;
  parallel_for(static_cast<std::size_t>(norm_bands), threads, [&](std::size_t band, int) {
    const int first = static_cast<int>(band) * kBandRows;
    norm_rows(integrals, tile_size_px, first, std::min(positions.height, first + kBandRows), strip);
  });
}

}  // namespace pilotage
