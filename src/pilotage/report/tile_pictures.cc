#include "pilotage/report/tile_pictures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <mutex>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "pilotage/base/parallel.h"
#include "pilotage/mission/plan_imagery.h"

namespace pilotage {
namespace {

constexpr std::array<int, 4> kSides_px = {96, 64, 48, 32};
constexpr double kMaxPixels = 6e6;
constexpr double kMaxPixelsSmallest = 16e6;
constexpr double kNoImagery = 192;  // gray, as the map's background

struct SmallPicture {
  cv::Mat pixels;   // CV_32FC3 or CV_32FC1, side × side
  cv::Mat covered;  // CV_32FC1, share of each pixel with imagery
};

// Averages over the pixels with imagery only, so that what is missing does not darken the rest.
SmallPicture shrink(const Raster& raster, int side_px) {
  cv::Mat pixels;
  raster.pixels.convertTo(pixels, CV_32F);
  cv::Mat weight;
  raster.valid.convertTo(weight, CV_32F, 1.0 / 255);
  std::vector<cv::Mat> channels;
  cv::split(pixels, channels);
  const cv::Size size(side_px, side_px);
  SmallPicture picture;
  cv::resize(weight, picture.covered, size, 0, 0, cv::INTER_AREA);
  for (cv::Mat& channel : channels) {
    channel.setTo(0, raster.valid == 0);  // may be NaN
    cv::resize(channel, channel, size, 0, 0, cv::INTER_AREA);
    cv::divide(channel, cv::max(picture.covered, 1e-6F), channel);
  }
  cv::merge(channels, picture.pixels);
  return picture;
}

struct Linear {
  double low = 0;
  double per_level = 1;
};

// From stored values to 0 … 255, per channel.
std::vector<Linear> stretch_of(const std::vector<SmallPicture>& pictures, int depth, int channels) {
  std::vector<Linear> stretch(static_cast<std::size_t>(channels));
  if (depth == CV_8U) return stretch;
  for (int channel = 0; channel < channels; ++channel) {
    std::vector<float> values;
    for (const SmallPicture& picture : pictures) {
      for (int y = 0; y < picture.pixels.rows; ++y) {
        for (int x = 0; x < picture.pixels.cols; ++x) {
          if (picture.covered.at<float>(y, x) > 0.5F)
            values.push_back(picture.pixels.ptr<float>(y)[x * channels + channel]);
        }
      }
    }
    if (values.empty()) continue;
    const auto percentile = [&](double share) {
      const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
      std::nth_element(values.begin(), at, values.end());
      return static_cast<double>(*at);
    };
    const double low = percentile(0.02);
    const double high = percentile(0.98);
    stretch[static_cast<std::size_t>(channel)] = {low, high > low ? 255 / (high - low) : 1};
  }
  return stretch;
}

cv::Mat rgb8(const SmallPicture& picture, const std::vector<Linear>& stretch) {
  std::vector<cv::Mat> channels;
  cv::split(picture.pixels, channels);
  for (std::size_t i = 0; i < channels.size(); ++i) {
    channels[i].convertTo(channels[i], CV_8U, stretch[i].per_level, -stretch[i].low * stretch[i].per_level);
    channels[i].setTo(kNoImagery, picture.covered < 0.5F);
  }
  while (channels.size() < 3) channels.push_back(channels.front());
  cv::Mat rgb;
  cv::merge(channels, rgb);
  return rgb;
}

}  // namespace

int tile_picture_side_px(std::size_t tiles) {
  const auto count = static_cast<double>(tiles);
  for (const int side_px : kSides_px) {
    if (count * side_px * side_px <= kMaxPixels) return side_px;
  }
  return count * kSides_px.back() * kSides_px.back() <= kMaxPixelsSmallest ? kSides_px.back() : 0;
}

TilePictures read_tile_pictures(const TilePlan& plan, int threads, const Progress& progress) {
  TilePictures result;
  result.side_px = tile_picture_side_px(plan.tiles.size());
  if (result.side_px == 0 || plan.tiles.empty()) return {};
  std::map<int, ColorSource> sources;
  std::map<int, const PlanLevel*> levels;
  for (const PlanLevel& level : plan.levels) {
    sources.emplace(level.matrix.level, open_plan_colors(plan, level));
    levels[level.matrix.level] = &level;
  }
  std::vector<SmallPicture> pictures(plan.tiles.size());
  std::mutex mutex;
  std::int64_t done = 0;
  parallel_for(plan.tiles.size(), threads, [&](std::size_t i, int) {
    const PlanTile& tile = plan.tiles[i];
    const PixelWindow window = levels.at(tile.level)->matrix.tile_window(tile.column, tile.row);
    pictures[i] = shrink(sources.at(tile.level).read(window), result.side_px);
    const std::lock_guard lock(mutex);
    report_progress(progress, "pictures of tiles", ++done, static_cast<std::int64_t>(plan.tiles.size()));
  });
  const ColorSource& source = sources.begin()->second;
  const std::vector<Linear> stretch = stretch_of(pictures, source.depth, source.channels);
  result.columns = std::max(1, static_cast<int>(std::ceil(std::sqrt(static_cast<double>(pictures.size())))));
  const int rows = static_cast<int>((pictures.size() + static_cast<std::size_t>(result.columns) - 1) /
                                    static_cast<std::size_t>(result.columns));
  result.sheet = cv::Mat(rows * result.side_px, result.columns * result.side_px, CV_8UC3, cv::Scalar::all(kNoImagery));
  for (std::size_t i = 0; i < pictures.size(); ++i) rgb8(pictures[i], stretch).copyTo(result.sheet(result.place(i)));
  return result;
}

}  // namespace pilotage
