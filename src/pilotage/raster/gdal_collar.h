#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "pilotage/raster/collar.h"
#include "pilotage/raster/gdal_handle.h"
#include "pilotage/raster/gdal_imagery.h"

// Private to raster/gdal_*.cc: the collar of a raster that says of no pixel that it is not ground
// (docs/decisions/collars.md).

namespace pilotage {

/// 8.6 Gpx, some 90,000 px squared: a minute or two of decoding.
inline constexpr std::int64_t kMostCollarSearch_px = std::int64_t{1} << 33;

/// The collar of a raster, and what is to be said about it.
struct CollarFinding {
  std::shared_ptr<const Collar> collar;  ///< Null where there is none.
  std::string warning;                   ///< "" where there is nothing to say.
};

/// Looks for black and white that reaches in from the raster's edge. Reads at most 1024 short lines of pixels along the
/// edge; only where one of them is black or white, the whole raster, once, in strips. A raster that was looked at
/// before, and whose file has not changed since, is not read again in this run. A raster of more than
/// kMostCollarSearch_px pixels is not read through; the warning then says so. `info` is of a raster without a mask.
/// Throws DataError when the pixels cannot be read, Interrupted.
CollarFinding find_collar(const ImageryInfo& info, const ImageryOptions& options, const Progress& progress);

/// A raster of one band, 0 in the collar and 255 elsewhere; `collar` lives on in it.
DatasetPtr make_collar_alpha(const std::shared_ptr<const Collar>& collar);

}  // namespace pilotage
