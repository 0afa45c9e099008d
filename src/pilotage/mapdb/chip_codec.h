#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <opencv2/core/mat.hpp>

#include "pilotage/mapdb/map_types.h"

#pragma GCC visibility push(default)

namespace pilotage {

// The picture of a map chip between pixels and bytes, encoding "chip1+zstd" of schemas/pilotage_descriptors.md: gray
// values in equal steps, each predicted from its neighbours (the median predictor of M. Weinberger, G. Seroussi,
// G. Sapiro, "The LOCO-I lossless image compression algorithm", IEEE Trans. Image Processing 9(8), 2000), what the
// prediction misses compressed with zstd (RFC 8878). Pixels without ground are a plane of bits.

inline constexpr std::string_view kGrayEncoding = "gray8";
inline constexpr std::string_view kChipEncoding = "chip1+zstd";

/// A chip's pixels. Pixel (c, r) covers the square of `factor` × `factor` pixels of the level whose first is
/// (window.col + c·factor, window.row + r·factor).
struct ChipPicture {
  cv::Mat gray;   ///< CV_8UC1. 0 where not valid.
  cv::Mat valid;  ///< CV_8UC1: 255 where there is ground, else 0.
  int factor = 1;
};

/// Reduces a window of a level to a chip's pixels: the mean of the valid pixels of each square, rounded to nearest;
/// valid where at least half of the square is. `gray` and `valid` are CV_8UC1 of one size, whose sides are multiples of
/// `factor`. Throws UsageError otherwise.
ChipPicture reduce_to_chip(const cv::Mat& gray, const cv::Mat& valid, int factor);

/// The chip of `picture` whose first pixel begins at (col_px, row_px) of the level. Gray values are kept in at most
/// 2^gray_bits equal steps (1 … 8) between the darkest and the brightest valid pixel, so that faint ground keeps fine
/// steps; the largest error is half a step, (brightest − darkest) / (2·(2^gray_bits − 1)), rounded up. Throws
/// UsageError when types, sizes, factor or gray_bits are not as said, or the picture has more than kMaxChipPixels.
MapChip encode_chip(const ChipPicture& picture, std::int64_t tile_id, int level, std::int64_t col_px,
                    std::int64_t row_px, int gray_bits);

/// The pixels of a chip with encoding kChipEncoding or kGrayEncoding (factor 1, all valid). Whatever bytes it holds,
/// the answer is a picture or a DataError that begins with `file` and names tile and level; at most 3·kMaxChipPixels
/// bytes are allocated for it.
ChipPicture decode_chip(const MapChip& chip, const std::string& file);

}  // namespace pilotage

#pragma GCC visibility pop
