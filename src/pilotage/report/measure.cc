#include "pilotage/report/measure.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <opencv2/imgproc.hpp>

namespace pilotage {
namespace {

// Nearest rank: the smallest value that at least `share` of all values do not exceed. `sorted` is not empty.
double percentile(const std::vector<double>& sorted, double share) {
  const double rank = std::ceil(share * static_cast<double>(sorted.size()));
  const auto index = static_cast<std::size_t>(std::max(rank, 1.0)) - 1;
  return sorted[std::min(index, sorted.size() - 1)];
}

// Shares and probabilities are always shown from 0 to 1.
bool is_share(std::string_view name) {
  constexpr std::array<std::string_view, 5> kShares = {"valid_fraction", "p_correct_fix", "vegetation_share",
                                                       "water_share", "epoch_survival"};
  return std::find(kShares.begin(), kShares.end(), name) != kShares.end();
}

}  // namespace

std::array<Rgb, 256> color_table(ColorMap map) {
  cv::Mat ramp(1, 256, CV_8UC1);
  for (int i = 0; i < 256; ++i) ramp.at<std::uint8_t>(0, i) = static_cast<std::uint8_t>(i);
  cv::Mat colors;  // blue, green, red
  cv::applyColorMap(ramp, colors, map == ColorMap::kViridis ? cv::COLORMAP_VIRIDIS : cv::COLORMAP_CIVIDIS);
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

const std::vector<Measure>& report_measures() {
  static const std::vector<Measure> measures = {
      {"p_correct_fix", "P(correct fix)", "1",
       "Probability that the matcher finds a frame taken here on another day, and is right; from one date of imagery. "
       "This "
       "is the measure to judge by.",
       ColorMap::kViridis, 2, [](const TileScore& score) { return score.p_correct_fix; }},
      {"degraded_peak_margin", "Uniqueness, degraded copies", "NCC",
       "Correlation at the true place minus the best rival in the search area, mean over degraded copies of the tile. "
       "Above 0 "
       "the true place wins.",
       ColorMap::kViridis, 3, [](const TileScore& score) { return score.degraded.margin; }},
      {"clean_peak_margin", "Uniqueness, clean", "NCC",
       "Correlation at the true place minus the best rival, the tile matched against its own map. On fine imagery it "
       "is "
       "high even over grass and water: do not judge by it alone.",
       ColorMap::kViridis, 3, [](const TileScore& score) { return score.clean.margin; }},
      {"gray_variance", "Gray variance", "gray levels",
       "Standard deviation of the gray values (Eq. 1, with the square root): how much contrast there is.",
       ColorMap::kCividis, 1, [](const TileScore& score) { return score.gray_variance; }},
      {"frieden_deficit", "Frieden deficit", "1",
       "N (1 − H/e) − 1: the entropy in a scale a person can read; about the squared ratio of contrast to brightness.",
       ColorMap::kCividis, 4, [](const TileScore& score) { return score.frieden_deficit; }},
      {"frieden_entropy", "Frieden entropy", "1",
       "H = Σ p e^(1 − p) (Eq. 2, 3). It saturates just below e = 2.71828…: two tiles differ in the sixth digit.",
       ColorMap::kCividis, 9, [](const TileScore& score) { return score.frieden_entropy; }},
      {"valid_fraction", "Imagery coverage", "1", "Share of the tile's pixels that the imagery covers.",
       ColorMap::kCividis, 3, [](const TileScore& score) { return score.valid_fraction; }},
      {"map_features", "Features of the map", "features", "Features that the map would hold of the tile.",
       ColorMap::kCividis, 0, [](const TileScore& score) { return score.map_features; }},
      {"vegetation_share", "Green ground", "1",
       "Share of the tile that is green: plants look different in another season.", ColorMap::kCividis, 2,
       [](const TileScore& score) { return score.vegetation_share; }},
      {"water_share", "Open water", "1", "Share of the tile that looks like open water: nothing there stays.",
       ColorMap::kCividis, 2, [](const TileScore& score) { return score.water_share; }},
      {"relief_m", "Relief", "m", "Highest minus lowest ground of the tile.", ColorMap::kCividis, 0,
       [](const TileScore& score) { return score.relief_m; }},
      {"epoch_margin", "Second date: margin", "NCC",
       "Correlation with the registered second date at the true place minus the best wrong place: measured, where "
       "uniqueness is predicted.",
       ColorMap::kViridis, 3, [](const TileScore& score) { return score.epoch.margin; }},
      {"epoch_survival", "Second date: features that stayed", "1",
       "Share of the tile's descriptors found in both dates.", ColorMap::kViridis, 2,
       [](const TileScore& score) { return score.epoch.survival; }},
      {"epoch_disagreement_m", "Second date: georeferences apart", "m",
       "Distance between the georeferences of both dates: what a fix may be off even where it is right.",
       ColorMap::kCividis, 1, [](const TileScore& score) { return score.epoch.disagreement_m; }},
  };
  return measures;
}

MeasureScale measure_scale(const Measure& measure, const std::vector<TileScore>& scores) {
  std::vector<double> values;
  for (const TileScore& score : scores) {
    const double value = measure.value(score);
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
  if (is_share(measure.name) || values.empty()) return scale;
  scale.low = percentile(values, 0.02);
  scale.high = percentile(values, 0.98);
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
