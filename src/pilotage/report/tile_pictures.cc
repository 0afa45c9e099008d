#include "pilotage/report/tile_pictures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <mutex>
#include <vector>

#include "pilotage/base/parallel.h"
#include "pilotage/ground/ground_imagery.h"
#include "pilotage/raster/gdal_io.h"

namespace pilotage {
namespace {

constexpr std::array<int, 4> kSides_px = {96, 64, 48, 32};
constexpr double kMaxPixels = 6e6;
constexpr double kMaxPixelsSmallest = 16e6;
constexpr double kNoImagery = 192;  // gray, as the map's background

// The imagery of a level on a grid whose pixels are those of the pictures. A tile begins at the pixel nearest to its
// corner, so a picture is off by half a pixel at most.
struct PictureGrid {
  double scale = 1;  // pixels of the level in one of the grid
  ColorSource colors;
};

PictureGrid open_pictures(const Ground& ground, const GridLevel& level, int side_px) {
  const TileMatrix& matrix = level.matrix;
  PictureGrid grid;
  grid.scale = static_cast<double>(matrix.tile_size_px) / side_px;
  GeoTransform place = matrix.map_from_pixel;
  for (double* step : {&place.x_per_col, &place.x_per_row, &place.y_per_col, &place.y_per_row}) *step *= grid.scale;
  const auto pixels = [&](std::int64_t extent_px) {
    return std::max<std::int64_t>(side_px, std::llround(std::ceil(static_cast<double>(extent_px) / grid.scale)));
  };
  grid.colors = open_colors_on_grid(dataset_names(ground.imagery), ground.crs, place, pixels(matrix.grid_width_px),
                                    pixels(matrix.grid_height_px), ground.imagery.options);
  return grid;
}

PixelWindow picture_window(const PictureGrid& grid, const GridLevel& level, const GroundTile& tile, int side_px) {
  const PixelWindow window = level.matrix.tile_window(tile.column, tile.row);
  const auto begin = [&](std::int64_t at_px, std::int64_t extent_px) {
    return std::clamp<std::int64_t>(std::llround(static_cast<double>(at_px) / grid.scale), 0, extent_px - side_px);
  };
  return {begin(window.col, grid.colors.width_px), begin(window.row, grid.colors.height_px), side_px, side_px};
}

struct Linear {
  double low = 0;
  double per_level = 1;
};

// From stored values to 0 … 255, per channel: as they are, or stretched over the valid pixels of all pictures.
std::vector<Linear> stretch_of(const std::vector<Raster>& pictures, int depth, int channels) {
  std::vector<Linear> stretch(static_cast<std::size_t>(channels));
  if (depth == CV_8U) return stretch;
  for (int channel = 0; channel < channels; ++channel) {
    std::vector<double> values;
    for (const Raster& picture : pictures) {
      cv::Mat numbers;
      cv::extractChannel(picture.pixels, numbers, channel);
      numbers.convertTo(numbers, CV_64F);
      for (int y = 0; y < numbers.rows; ++y) {
        for (int x = 0; x < numbers.cols; ++x) {
          if (picture.valid.at<std::uint8_t>(y, x) != 0) values.push_back(numbers.at<double>(y, x));
        }
      }
    }
    if (values.empty()) continue;
    const auto percentile = [&](double share) {
      const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
      std::nth_element(values.begin(), at, values.end());
      return *at;
    };
    const double low = percentile(0.02);
    const double high = percentile(0.98);
    stretch[static_cast<std::size_t>(channel)] = {low, high > low ? 255 / (high - low) : 1};
  }
  return stretch;
}

cv::Mat rgb8(const Raster& picture, const std::vector<Linear>& stretch) {
  std::vector<cv::Mat> channels;
  cv::split(picture.pixels, channels);
  for (std::size_t i = 0; i < channels.size(); ++i) {
    channels[i].convertTo(channels[i], CV_8U, stretch[i].per_level, -stretch[i].low * stretch[i].per_level);
    channels[i].setTo(kNoImagery, picture.valid == 0);
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

TilePictures read_tile_pictures(const Ground& ground, int threads, const Progress& progress) {
  TilePictures result;
  result.side_px = tile_picture_side_px(ground.tiles.size());
  if (result.side_px == 0 || ground.tiles.empty()) return {};
  std::map<int, PictureGrid> grids;
  std::map<int, const GridLevel*> levels;
  for (const GridLevel& level : ground.levels) {
    grids.emplace(level.matrix.level, open_pictures(ground, level, result.side_px));
    levels[level.matrix.level] = &level;
  }
  std::vector<Raster> pictures(ground.tiles.size());
  std::mutex mutex;
  std::int64_t done = 0;
  parallel_for(ground.tiles.size(), threads, [&](std::size_t i, int) {
    const GroundTile& tile = ground.tiles[i];
    const PictureGrid& grid = grids.at(tile.level);
    pictures[i] = grid.colors.read(picture_window(grid, *levels.at(tile.level), tile, result.side_px));
    const std::lock_guard lock(mutex);
    report_progress(progress, "pictures of tiles", ++done, static_cast<std::int64_t>(ground.tiles.size()));
  });
  const ColorSource& source = grids.begin()->second.colors;
  const std::vector<Linear> stretch = stretch_of(pictures, source.depth, source.channels);
  result.columns = std::max(1, static_cast<int>(std::ceil(std::sqrt(static_cast<double>(pictures.size())))));
  const int rows = static_cast<int>((pictures.size() + static_cast<std::size_t>(result.columns) - 1) /
                                    static_cast<std::size_t>(result.columns));
  result.sheet = cv::Mat(rows * result.side_px, result.columns * result.side_px, CV_8UC3, cv::Scalar::all(kNoImagery));
  for (std::size_t i = 0; i < pictures.size(); ++i) rgb8(pictures[i], stretch).copyTo(result.sheet(result.place(i)));
  return result;
}

}  // namespace pilotage
