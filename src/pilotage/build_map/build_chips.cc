#include "pilotage/build_map/build_chips.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/parallel.h"
#include "pilotage/vision/direction_field.h"

namespace pilotage {
namespace {

/// Pixels of the grid of chips.
struct ChipCells {
  std::int64_t col = 0;
  std::int64_t row = 0;
  cv::Mat owned;  // CV_8U: 255 where the tile owns the pixel
};

/// The pixels of the grid of chips whose centres the tile owns, cut to their bounding box; nothing when it owns none.
std::optional<ChipCells> owned_cells(const TileMatrix& matrix, const GroundTile& tile, const TileOwner& owner,
                                     int factor) {
  const PixelWindow window = matrix.tile_window(tile.column, tile.row);
  const std::int64_t first_col = window.col / factor;
  const std::int64_t first_row = window.row / factor;
  const auto width = static_cast<int>((window.col + window.width + factor - 1) / factor - first_col);
  const auto height = static_cast<int>((window.row + window.height + factor - 1) / factor - first_row);
  cv::Mat owned = cv::Mat::zeros(height, width, CV_8UC1);
  for (int row = 0; row < height; ++row) {
    auto* line = owned.ptr<std::uint8_t>(row);
    const double y_px = (static_cast<double>(first_row + row) + 0.5) * factor;
    for (int col = 0; col < width; ++col) {
      const double x_px = (static_cast<double>(first_col + col) + 0.5) * factor;
      if (owner.owner_of(x_px, y_px) == TileCell{tile.column, tile.row}) line[col] = 255;
    }
  }
  const cv::Rect box = cv::boundingRect(owned);
  if (box.empty()) return std::nullopt;
  return ChipCells{first_col + box.x, first_row + box.y, owned(box)};
}

/// CV_8UC1.
struct ReducedGray {
  cv::Mat pixels;
  cv::Mat valid;
};

/// Means over squares of factor × factor, of their valid pixels; valid where at least half of a square is.
ReducedGray reduce(const cv::Mat& gray, const cv::Mat& valid, int factor) {
  ReducedGray reduced{cv::Mat::zeros(gray.rows / factor, gray.cols / factor, CV_8UC1),
                      cv::Mat::zeros(gray.rows / factor, gray.cols / factor, CV_8UC1)};
  for (int row = 0; row < reduced.pixels.rows; ++row) {
    for (int col = 0; col < reduced.pixels.cols; ++col) {
      int sum = 0;
      int count = 0;
      for (int y = row * factor; y < (row + 1) * factor; ++y) {
        const auto* gray_line = gray.ptr<std::uint8_t>(y);
        const auto* valid_line = valid.ptr<std::uint8_t>(y);
        for (int x = col * factor; x < (col + 1) * factor; ++x) {
          if (valid_line[x] == 0) continue;
          sum += gray_line[x];
          ++count;
        }
      }
      if (2 * count < factor * factor) continue;
      reduced.pixels.at<std::uint8_t>(row, col) = static_cast<std::uint8_t>((2 * sum + count) / (2 * count));
      reduced.valid.at<std::uint8_t>(row, col) = 255;
    }
  }
  return reduced;
}

/// The tile's chip; nothing when no imagery covers what it owns.
std::optional<MapChip> make_chip(const TileMatrix& matrix, const GroundTile& tile, const TileOwner& owner,
                                 const GraySource& source, int factor) {
  const auto cells = owned_cells(matrix, tile, owner, factor);
  if (!cells) return std::nullopt;
  // With what the directions of its outermost pixels depend on; a part of it may lie beyond the grid.
  const int margin = kDirectionReachPx * factor;
  const PixelWindow window{cells->col * factor, cells->row * factor, cells->owned.cols * factor,
                           cells->owned.rows * factor};
  const std::int64_t first_col = std::max<std::int64_t>(0, window.col - margin);
  const std::int64_t first_row = std::max<std::int64_t>(0, window.row - margin);
  const std::int64_t end_col = std::min(window.col + window.width + margin, source.width_px);
  const std::int64_t end_row = std::min(window.row + window.height + margin, source.height_px);
  const PixelWindow seen{first_col, first_row, static_cast<int>(end_col - first_col),
                         static_cast<int>(end_row - first_row)};
  cv::Mat gray = cv::Mat::zeros(window.height + 2 * margin, window.width + 2 * margin, CV_8UC1);
  cv::Mat valid = gray.clone();
  const Raster read = source.read(seen);
  const cv::Rect inside(static_cast<int>(first_col - window.col) + margin,
                        static_cast<int>(first_row - window.row) + margin, seen.width, seen.height);
  read.pixels.copyTo(gray(inside));
  read.valid.copyTo(valid(inside));
  ChipPicture picture = make_chip_picture(gray, valid, factor);
  picture.valid &= cells->owned;
  picture.steps.setTo(0, picture.valid == 0);
  if (cv::countNonZero(picture.valid) == 0) return std::nullopt;
  return encode_chip(picture, tile.tile_id, tile.level, window.col, window.row);
}

}  // namespace

ChipPicture make_chip_picture(const cv::Mat& gray, const cv::Mat& valid, int factor) {
  constexpr int kMargin = kDirectionReachPx;
  if (gray.type() != CV_8UC1 || valid.type() != CV_8UC1 || gray.size() != valid.size() || factor < 1 ||
      factor > kMaxChipFactor || gray.cols % factor != 0 || gray.rows % factor != 0 ||
      std::min(gray.cols, gray.rows) <= 2 * kMargin * factor) {
    throw UsageError(
        "chip: gray and valid must be CV_8UC1 of one size in multiples of factor = " + std::to_string(factor) +
        ", 1 to " + std::to_string(kMaxChipFactor) + ", and more than " + std::to_string(2 * kMargin) + " of them");
  }
  const ReducedGray reduced = reduce(gray, valid, factor);
  const DirectionField field = direction_field(reduced.pixels, reduced.valid);
  const cv::Rect inside(kMargin, kMargin, reduced.pixels.cols - 2 * kMargin, reduced.pixels.rows - 2 * kMargin);
  return {direction_steps(field.z)(inside).clone(), field.valid(inside).clone(), factor};
}

int chip_factor(const ChipOptions& options, double gsd_m) {
  return static_cast<int>(std::clamp(std::round(options.chip_gsd_m / gsd_m), 1.0, static_cast<double>(kMaxChipFactor)));
}

double chip_bytes_per_px(const ChipOptions& options, double gsd_m) {
  if (!options.chips) return 0;
  // Nine steps take at most 4 bits in a prefix code, and the mask one more; zstd never stores more than a byte.
  constexpr double kFullPages = 1.02;    // page headers and overflow pointers
  constexpr double kBorderPixels = 1.1;  // a side of s px holds up to s/factor + 1 centres
  const double bits = 5;
  const double factor = chip_factor(options, gsd_m);
  return bits / 8 / (factor * factor) * kFullPages * kBorderPixels;
}

ChipStats write_chips(MapWriter& writer, const GridLevel& level, const std::vector<const GroundTile*>& tiles,
                      const TileOwner& owner, const GraySource& source, const ChipOptions& options, int threads,
                      const Progress& progress) {
  constexpr std::size_t kBatch = 64;  // of chips in memory
  const int factor = chip_factor(options, level.gsd_m);
  ChipStats stats;
  const std::string what = "chips of level " + std::to_string(level.matrix.level);
  report_progress(progress, what, 0, std::ssize(tiles));
  for (std::size_t begin = 0; begin < tiles.size(); begin += kBatch) {
    std::vector<std::optional<MapChip>> chips(std::min(kBatch, tiles.size() - begin));
    parallel_for(chips.size(), threads, [&](std::size_t i, int) {
      chips[i] = make_chip(level.matrix, *tiles[begin + i], owner, source, factor);
    });
    for (const auto& chip : chips) {
      if (!chip) continue;
      writer.add_chip(*chip);
      ++stats.chips;
      stats.bytes += static_cast<std::int64_t>(chip->data.size());
    }
    report_progress(progress, what, static_cast<std::int64_t>(begin + chips.size()), std::ssize(tiles));
  }
  return stats;
}

}  // namespace pilotage
