#include "pilotage/match/chip_mosaic.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/mapdb/chip_codec.h"

namespace pilotage {
namespace {

constexpr double kMaxCenterPx = 0x1p41;  // beyond every window a map can hold

/// The square in pixels of the level.
struct Square {
  Eigen::Vector2d low_px;
  Eigen::Vector2d high_px;
};

Square square_about(const Eigen::Vector2d& center_px, double half_width_px) {
  const Eigen::Vector2d half(half_width_px, half_width_px);
  return {center_px - half, center_px + half};
}

const MapLevel& checked_level(const MapReader& map, int level, const Eigen::Vector2d& center_px, double half_width_px) {
  const MapLevel* found = map.find_level(level);
  if (found == nullptr) throw UsageError("the map has no level " + std::to_string(level));
  if (!(center_px.cwiseAbs().maxCoeff() <= kMaxCenterPx)) throw UsageError("the centre of the mosaic is not a place");
  constexpr double kMax = 0.5 * kMaxMosaicSidePx * kMaxChipFactor;
  if (!(half_width_px > 0 && half_width_px <= kMax)) {
    throw UsageError("half_width_px = " + format_number(half_width_px) + " is outside (0, " + format_number(kMax) +
                     "]");
  }
  return *found;
}

/// An empty picture of the square on the grid of chips of this factor.
ChipMosaic empty_mosaic(const Square& square, int factor) {
  const auto first = [&](double low) { return static_cast<std::int64_t>(std::floor(low / factor)); };
  const auto end = [&](double high) { return static_cast<std::int64_t>(std::ceil(high / factor)); };
  const std::int64_t col = first(square.low_px.x());
  const std::int64_t row = first(square.low_px.y());
  const std::int64_t width = std::max<std::int64_t>(1, end(square.high_px.x()) - col);
  const std::int64_t height = std::max<std::int64_t>(1, end(square.high_px.y()) - row);
  if (std::max(width, height) > kMaxMosaicSidePx) {
    throw UsageError("a mosaic of " + std::to_string(width) + " × " + std::to_string(height) + " px is larger than " +
                     std::to_string(kMaxMosaicSidePx));
  }
  ChipMosaic mosaic;
  mosaic.factor = factor;
  mosaic.first_col_px = col * factor;
  mosaic.first_row_px = row * factor;
  mosaic.steps = cv::Mat::zeros(static_cast<int>(height), static_cast<int>(width), CV_8UC1);
  mosaic.valid = mosaic.steps.clone();
  return mosaic;
}

void paste(const ChipPicture& picture, const PixelWindow& window, ChipMosaic& mosaic) {
  const int factor = mosaic.factor;
  const std::int64_t col = (window.col - mosaic.first_col_px) / factor;  // exact: both are multiples
  const std::int64_t row = (window.row - mosaic.first_row_px) / factor;
  const std::int64_t from_col = std::max<std::int64_t>(0, col);
  const std::int64_t from_row = std::max<std::int64_t>(0, row);
  const std::int64_t end_col = std::min<std::int64_t>(mosaic.steps.cols, col + picture.steps.cols);
  const std::int64_t end_row = std::min<std::int64_t>(mosaic.steps.rows, row + picture.steps.rows);
  if (from_col >= end_col || from_row >= end_row) return;
  const cv::Rect to(static_cast<int>(from_col), static_cast<int>(from_row), static_cast<int>(end_col - from_col),
                    static_cast<int>(end_row - from_row));
  const cv::Rect from = to - cv::Point(static_cast<int>(col), static_cast<int>(row));
  const cv::Mat valid = picture.valid(from);
  picture.steps(from).copyTo(mosaic.steps(to), valid);
  valid.copyTo(mosaic.valid(to), valid);
}

/// Whether a chip of the tile may touch the square: it reaches beyond its tile by less than one of its pixels.
bool may_touch(const MapTile& tile, const GeoTransform& transform, const Square& square) {
  const Bounds& b = tile.bounds;
  Eigen::AlignedBox2d tile_px;
  for (const double x_m : {b.min_x_m, b.max_x_m}) {
    for (const double y_m : {b.min_y_m, b.max_y_m}) tile_px.extend(transform.pixel_from_map({x_m, y_m}));
  }
  const Eigen::Vector2d slack_px = Eigen::Vector2d::Constant(kMaxChipFactor);
  return tile_px.intersects(Eigen::AlignedBox2d(square.low_px - slack_px, square.high_px + slack_px));
}

bool touches(const PixelWindow& window, const Square& square) {
  const auto reaches = [](std::int64_t first, int size, double low, double high) {
    return static_cast<double>(first)<high&& static_cast<double>(first + size)> low;
  };
  return reaches(window.col, window.width, square.low_px.x(), square.high_px.x()) &&
         reaches(window.row, window.height, square.low_px.y(), square.high_px.y());
}

/// Calls `use` with the chips that lie in the square, nearest tile first, until it returns false.
void for_each_chip(MapReader& map, int level, const Eigen::Vector2d& center_px, double half_width_px,
                   const std::function<bool(std::int64_t tile_id, const DecodedChip& chip)>& use) {
  const GeoTransform& transform = checked_level(map, level, center_px, half_width_px).matrix.map_from_pixel;
  if (!map.has_chips()) return;
  const Square square = square_about(center_px, half_width_px);
  // From the centre to a corner of the square; a chip reaches beyond its tile by less than one of its pixels.
  const double pixel_m = std::max(std::hypot(transform.x_per_col, transform.y_per_col),
                                  std::hypot(transform.x_per_row, transform.y_per_row));
  const double radius_m = (half_width_px + kMaxChipFactor) * std::sqrt(2.0) * pixel_m;
  const Eigen::Vector2d center_m = transform.map_from_pixel(center_px);
  if (!center_m.allFinite() || !std::isfinite(radius_m)) throw UsageError("the centre of the mosaic is not a place");
  for (const NearTile& near : map.tiles_near(center_m, radius_m, level)) {
    if (!may_touch(near.tile, transform, square)) continue;
    const auto chip = map.decoded_chip(near.tile.tile_id, level);
    if (chip && touches(chip->window, square) && !use(near.tile.tile_id, *chip)) return;
  }
}

}  // namespace

ChipMosaic read_chip_mosaic(MapReader& map, int level, const Eigen::Vector2d& center_px, double half_width_px,
                            const Checkpoint& checkpoint) {
  ChipMosaic mosaic;
  for_each_chip(map, level, center_px, half_width_px, [&](std::int64_t tile_id, const DecodedChip& chip) {
    pass(checkpoint);
    const ChipPicture& picture = chip.picture;
    if (mosaic.steps.empty()) mosaic = empty_mosaic(square_about(center_px, half_width_px), picture.factor);
    if (picture.factor != mosaic.factor) {
      throw DataError(map.name() + ": tile " + std::to_string(tile_id) + ", level " + std::to_string(level) +
                      ": its chip's pixels have another size than its neighbours'");
    }
    paste(picture, chip.window, mosaic);
    return true;
  });
  return mosaic;
}

int chip_factor(MapReader& map, int level, const Eigen::Vector2d& center_px, double half_width_px) {
  int factor = 0;
  for_each_chip(map, level, center_px, half_width_px, [&](std::int64_t, const DecodedChip& chip) {
    factor = chip.picture.factor;
    return false;
  });
  return factor;
}

}  // namespace pilotage
