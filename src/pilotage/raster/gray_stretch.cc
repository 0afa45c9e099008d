#include "pilotage/raster/gray_stretch.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/raster/spread_starts.h"

namespace pilotage {
namespace {

constexpr int kSampleWindows = 16;  // per direction
constexpr int kSampleSide = 64;

std::vector<std::int64_t> sample_starts(std::int64_t extent_px) {
  const std::int64_t count = std::clamp<std::int64_t>((extent_px + kSampleSide - 1) / kSampleSide, 1, kSampleWindows);
  return spread_starts(extent_px, kSampleSide, count);
}

void append_valid(const Raster& raster, std::vector<double>& values) {
  cv::Mat pixels;
  raster.pixels.convertTo(pixels, CV_64F);
  for (int row = 0; row < pixels.rows; ++row) {
    for (int col = 0; col < pixels.cols; ++col) {
      if (raster.valid.at<std::uint8_t>(row, col) != 0) values.push_back(pixels.at<double>(row, col));
    }
  }
}

/// The smallest value that at least `percent` of the values do not exceed (nearest rank).
double percentile(std::vector<double>& values, double percent) {
  const double rank = std::ceil(percent / 100 * static_cast<double>(values.size()));
  const auto index = static_cast<std::ptrdiff_t>(std::clamp(rank - 1, 0.0, static_cast<double>(values.size() - 1)));
  std::nth_element(values.begin(), values.begin() + index, values.end());
  return values[static_cast<std::size_t>(index)];
}

}  // namespace

GrayStretch find_stretch(const GraySource& source, double low_percent, double high_percent) {
  if (!(low_percent >= 0 && low_percent < high_percent && high_percent <= 100)) {
    throw UsageError("a stretch from " + format_number(low_percent) + " % to " + format_number(high_percent) +
                     " % is not 0 <= low < high <= 100");
  }
  std::vector<double> values;
  for (const std::int64_t row : sample_starts(source.height_px)) {
    for (const std::int64_t col : sample_starts(source.width_px)) {
      const auto width = static_cast<int>(std::min<std::int64_t>(kSampleSide, source.width_px - col));
      const auto height = static_cast<int>(std::min<std::int64_t>(kSampleSide, source.height_px - row));
      append_valid(source.read({col, row, width, height}), values);
    }
  }
  if (values.empty()) return {};
  GrayStretch stretch{percentile(values, low_percent), percentile(values, high_percent)};
  if (!(stretch.low < stretch.high)) {
    // So few other values that the percentiles miss them: take the whole range before giving up.
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    stretch =
        *low < *high ? GrayStretch{*low, *high} : GrayStretch{*low, std::max(*low + 1, std::nextafter(*low, INFINITY))};
  }
  return stretch;
}

cv::Mat apply_stretch(const cv::Mat& pixels, const GrayStretch& stretch) {
  cv::Mat wide;
  pixels.convertTo(wide, CV_64F);
  cv::Mat result(wide.size(), CV_8U);
  const double range = stretch.high - stretch.low;
  for (int row = 0; row < wide.rows; ++row) {
    const auto* value = wide.ptr<double>(row);
    auto* byte = result.ptr<std::uint8_t>(row);
    for (int col = 0; col < wide.cols; ++col) {
      const double share = (value[col] - stretch.low) / range;
      byte[col] = share > 0 ? static_cast<std::uint8_t>(std::floor(255 * std::min(share, 1.0) + 0.5)) : std::uint8_t{0};
    }
  }
  return result;
}

GraySource stretch_to_8bit(const GraySource& source, double low_percent, double high_percent) {
  return source.depth == CV_8U ? source : stretch_to_8bit(source, find_stretch(source, low_percent, high_percent));
}

GraySource stretch_to_8bit(const GraySource& source, const GrayStretch& stretch) {
  GraySource stretched = source;
  stretched.depth = CV_8U;
  stretched.read = [read = source.read, stretch](const PixelWindow& window) {
    Raster raster = read(window);
    raster.pixels = apply_stretch(raster.pixels, stretch);
    return raster;
  };
  return stretched;
}

double valid_fraction(const GraySource& source, const PixelWindow& window) {
  return valid_fraction(source.read(window).valid);
}

double valid_fraction(const cv::Mat& valid) {
  return valid.empty() ? 0 : cv::countNonZero(valid) / static_cast<double>(valid.total());
}

}  // namespace pilotage
