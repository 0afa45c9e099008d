#pragma once

#include "pilotage/raster/raster.h"

namespace pilotage::testing {

/// All pixels of a GraySource or ColorSource.
template <class Source>
Raster read_all(const Source& source) {
  return source.read({0, 0, static_cast<int>(source.width_px), static_cast<int>(source.height_px)});
}

}  // namespace pilotage::testing
