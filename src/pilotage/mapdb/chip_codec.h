#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <opencv2/core/mat.hpp>

#include "pilotage/mapdb/map_types.h"

#pragma GCC visibility push(default)

namespace pilotage {

// The picture of a map chip between pixels and bytes, encoding "directions1+zstd" of schemas/pilotage_descriptors.md:
// the steps of direction_field.h, each told by its turn from a neighbour's, compressed with zstd (RFC 8878). Pixels
// without ground are a plane of bits.

inline constexpr std::string_view kChipEncoding = "directions1+zstd";

/// A chip's pixels. Pixel (c, r) covers the square of `factor` × `factor` pixels of the level whose first is
/// (window.col + c·factor, window.row + r·factor).
struct ChipPicture {
  cv::Mat steps;  ///< CV_8UC1: direction_steps(), 0 … kDirectionSectors. 0 where not valid.
  cv::Mat valid;  ///< CV_8UC1: 255 where there is ground, else 0.
  int factor = 1;
};

/// The chip of `picture` whose first pixel begins at (col_px, row_px) of the level. Nothing is lost but steps that are
/// not valid. Throws UsageError when types, sizes, factor or steps are not as said, or the picture has more than
/// kMaxChipPixels.
MapChip encode_chip(const ChipPicture& picture, std::int64_t tile_id, int level, std::int64_t col_px,
                    std::int64_t row_px);

/// The pixels of a chip with encoding kChipEncoding. Whatever bytes it holds, the answer is a picture or a DataError
/// that begins with `file` and names tile and level; at most 3·kMaxChipPixels bytes are allocated for it.
ChipPicture decode_chip(const MapChip& chip, const std::string& file);

}  // namespace pilotage

#pragma GCC visibility pop
