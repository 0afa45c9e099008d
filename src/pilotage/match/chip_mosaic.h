#pragma once

#include <cstdint>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pilotage/mapdb/map_reader.h"
#include "pilotage/match/checkpoint.h"

namespace pilotage {

/// The chips of one level put together: the directions of edges around a point. Pixel (c, r) covers the square of
/// `factor` × `factor` pixels of the level whose first is (first_col_px + c·factor, first_row_px + r·factor).
struct ChipMosaic {
  cv::Mat steps;  ///< direction_steps(); 0 where not valid. Empty when the map has no chip here.
  cv::Mat valid;  ///< CV_8UC1: 255 where a chip shows ground, else 0.
  std::int64_t first_col_px = 0;
  std::int64_t first_row_px = 0;
  int factor = 1;

  /// Of a position in the mosaic (outer corner of the first pixel at (0, 0)), in pixels of the level; and back.
  Eigen::Vector2d level_from_mosaic(const Eigen::Vector2d& position_px) const {
    return Eigen::Vector2d(static_cast<double>(first_col_px), static_cast<double>(first_row_px)) + factor * position_px;
  }
  Eigen::Vector2d mosaic_from_level(const Eigen::Vector2d& level_px) const {
    return (level_px - Eigen::Vector2d(static_cast<double>(first_col_px), static_cast<double>(first_row_px))) / factor;
  }
};

/// Largest side of a mosaic in its own pixels.
inline constexpr int kMaxMosaicSidePx = 8192;

/// The chips of `level` over the square of half side `half_width_px` about `center_px`, both in pixels of the level
/// (parts outside the map's chips are not valid). The chips of a map do not overlap. Throws DataError when the map is
/// damaged here or its chips do not share one grid; UsageError when the map has no such level, a number is not finite,
/// or the square is not within [1, kMaxMosaicSidePx] pixels of the chips.
ChipMosaic read_chip_mosaic(MapReader& map, int level, const Eigen::Vector2d& center_px, double half_width_px,
                            const Checkpoint& checkpoint = {});

/// Pixels of `level` along a side of a pixel of its chips, by the first chip that there is in the square; 0 when there
/// is none. Throws as read_chip_mosaic.
int chip_factor(MapReader& map, int level, const Eigen::Vector2d& center_px, double half_width_px);

}  // namespace pilotage
