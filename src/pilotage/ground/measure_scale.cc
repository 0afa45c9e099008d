#include "pilotage/ground/measure_scale.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include <opencv2/imgproc.hpp>

namespace pilotage {
namespace {

// Nearest rank: the smallest value that at least `share` of all values do not exceed. `sorted` is not empty.
double percentile(const std::vector<double>& sorted, double share) {
  const double rank = std::ceil(share * static_cast<double>(sorted.size()));
  const auto index = static_cast<std::size_t>(std::max(rank, 1.0)) - 1;
  return sorted[std::min(index, sorted.size() - 1)];
}

// Between its neighbours each channel grows linearly; the fourth is status_color of good. They lie where the way
// through CIE L*a*b* from each to the next puts them: equal steps of the table look alike.
std::array<Rgb, 256> blues() {
  constexpr std::array<Rgb, 5> kStops{
      {{0xf4, 0xf1, 0xea}, {0xb5, 0xd1, 0xe6}, {0x56, 0x9f, 0xce}, {0x00, 0x72, 0xb2}, {0x00, 0x32, 0x62}}};
  constexpr std::array<std::size_t, 5> kPlaces{0, 57, 127, 182, 255};
  std::array<Rgb, 256> table;
  for (std::size_t stop = 0; stop + 1 < kStops.size(); ++stop) {
    const Rgb& from = kStops[stop];
    const Rgb& to = kStops[stop + 1];
    const std::size_t length = kPlaces[stop + 1] - kPlaces[stop];
    for (std::size_t step = 0; step <= length; ++step) {
      const auto channel = [&](std::uint8_t a, std::uint8_t b) {
        return static_cast<std::uint8_t>(
            std::lround(a + static_cast<double>(step) / static_cast<double>(length) * (b - a)));
      };
      table[kPlaces[stop] + step] = {channel(from.red, to.red), channel(from.green, to.green),
                                     channel(from.blue, to.blue)};
    }
  }
  return table;
}

}  // namespace

std::array<Rgb, 256> color_table(ColorMap map) {
  if (map == ColorMap::kBlues) return blues();
  cv::Mat ramp(1, 256, CV_8UC1);
  for (int i = 0; i < 256; ++i) ramp.at<std::uint8_t>(0, i) = static_cast<std::uint8_t>(i);
  cv::Mat colors;  // blue, green, red
  cv::applyColorMap(ramp, colors, cv::COLORMAP_CIVIDIS);
  std::array<Rgb, 256> table;
  for (int i = 0; i < 256; ++i) {
    const auto& color = colors.at<cv::Vec3b>(0, i);
    table[static_cast<std::size_t>(i)] = {color[2], color[1], color[0]};
  }
  return table;
}

std::string hex_color(Rgb color) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text = "#";
  for (const unsigned part : {color.red, color.green, color.blue}) {
    text += kDigits[part >> 4];
    text += kDigits[part & 15];
  }
  return text;
}

MeasureScale measure_scale(const Measure& measure, const std::vector<TileScores>& scores) {
  std::vector<double> values;
  for (const TileScores& score : scores) {
    const double value = measure.get(score);
    if (std::isfinite(value)) values.push_back(value);
  }
  MeasureScale scale;
  scale.measure = measure;
  scale.least = scale.most = std::numeric_limits<double>::quiet_NaN();
  if (!values.empty()) {
    std::sort(values.begin(), values.end());
    scale.least = values.front();
    scale.most = values.back();
  }
  if ((measure.kind == MeasureKind::kShare && !measure.heat.ranks) || values.empty()) return scale;
  scale.low = percentile(values, 0.02);
  scale.high = percentile(values, 0.98);
  if (measure.kind == MeasureKind::kShare) {
    const double missing = std::max(0.0, MeasureScale::kLeastSpan - (scale.high - scale.low));
    scale.low = std::clamp(scale.low - missing / 2, 0.0, 1 - MeasureScale::kLeastSpan);
    scale.high = std::max(scale.high, std::min(1.0, scale.low + MeasureScale::kLeastSpan));
    return scale;
  }
  if (!(scale.high > scale.low)) {
    const double half = std::max(std::abs(scale.low) * 0x1p-20, 1e-9);
    scale.low -= half;
    scale.high += half;
  }
  return scale;
}

int shade(const MeasureScale& scale, double value) {
  if (!std::isfinite(value)) return -1;
  const double share = std::clamp((value - scale.low) / (scale.high - scale.low), 0.0, 1.0);
  return static_cast<int>(std::lround(share * 255));
}

}  // namespace pilotage
