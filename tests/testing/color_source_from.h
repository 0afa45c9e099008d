#pragma once

#include "pilotage/raster/color_source.h"

namespace pilotage::testing {

/// A source over pixels already in memory, one or three channels (shared, not copied).
inline ColorSource color_source_from(const Raster& raster) {
  const GraySource windows = gray_source_from(raster);  // windows of pixels in memory, whatever their channels
  return {windows.width_px,      windows.height_px, windows.map_from_pixel, {}, raster.pixels.channels(),
          raster.pixels.depth(), windows.read};
}

}  // namespace pilotage::testing
