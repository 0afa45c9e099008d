#include "pilotage/build_map/build_chips.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/parallel.h"
#include "pilotage/mapdb/chip_codec.h"

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

/// The tile's chip; nothing when no imagery covers what it owns.
std::optional<MapChip> make_chip(const TileMatrix& matrix, const GroundTile& tile, const TileOwner& owner,
                                 const GraySource& source, int factor, int gray_bits) {
  const auto cells = owned_cells(matrix, tile, owner, factor);
  if (!cells) return std::nullopt;
  PixelWindow window{cells->col * factor, cells->row * factor, cells->owned.cols * factor, cells->owned.rows * factor};
  cv::Mat gray = cv::Mat::zeros(window.height, window.width, CV_8UC1);
  cv::Mat valid = gray.clone();
  // The last pixels of a chip may reach beyond the grid by less than half their size.
  const auto width = static_cast<int>(std::min<std::int64_t>(window.width, source.width_px - window.col));
  const auto height = static_cast<int>(std::min<std::int64_t>(window.height, source.height_px - window.row));
  const Raster read = source.read({window.col, window.row, width, height});
  const cv::Rect inside(0, 0, width, height);
  read.pixels.copyTo(gray(inside));
  read.valid.copyTo(valid(inside));
  ChipPicture picture = reduce_to_chip(gray, valid, factor);
  picture.valid &= cells->owned;
  picture.gray.setTo(0, picture.valid == 0);
  if (cv::countNonZero(picture.valid) == 0) return std::nullopt;
  return encode_chip(picture, tile.tile_id, tile.level, window.col, window.row, gray_bits);
}

}  // namespace

int chip_factor(const ChipOptions& options, double gsd_m) {
  return static_cast<int>(std::clamp(std::round(options.chip_gsd_m / gsd_m), 1.0, static_cast<double>(kMaxChipFactor)));
}

double chip_bytes_per_px(const ChipOptions& options, double gsd_m) {
  if (!options.chips) return 0;
  // A prefix code needs no more than the bits of a step, and the mask one bit more; zstd never stores more than a byte.
  constexpr double kFullPages = 1.02;    // page headers and overflow pointers
  constexpr double kBorderPixels = 1.1;  // a side of s px holds up to s/factor + 1 centres
  const double bits = std::min(options.chip_gray_bits, 8) + 1;
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
      chips[i] = make_chip(level.matrix, *tiles[begin + i], owner, source, factor, options.chip_gray_bits);
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
