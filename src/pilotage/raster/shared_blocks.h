#pragma once

#include <cstdint>

#include "pilotage/raster/color_source.h"
#include "pilotage/raster/gray_source.h"

namespace pilotage {

/// The same pixels from a source whose blocks are dear (decoded or warped): a window is put together from blocks that
/// all threads share, so that windows that overlap, and threads that read side by side, do not make a block twice. The
/// last blocks used are kept: 16 million pixels or three rows of blocks, whichever is more. Of rows no more is kept
/// than 256 MiB, or than a slab (tiles_by_slab) has of them. Where these are not all, a window of whole blocks is read
/// past them. A source whose blocks are one pixel, or larger than the cache, is returned as it is.
GraySource share_blocks(const GraySource& source);

/// How many pixels of colours take so much memory, with their masks.
std::int64_t kept_pixels(const ColorSource& source, std::int64_t kept_bytes);

/// The same of colours; kept are the last `kept_bytes` of blocks, or three rows of them as above.
ColorSource share_blocks(const ColorSource& source, std::int64_t kept_bytes);

}  // namespace pilotage
