#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/geo/geo_transform.h"
#include "pilotage/geo/tile_matrix.h"
#include "pilotage/raster/crs.h"

namespace pilotage {

/// What says whether a raster is still the one that it was: size and type of its pixels, and size and time of all its
/// files, or of the address, where its server tells them. Throws DataError when it cannot be opened.
std::string dataset_version(const std::string& dataset);

/// A part of a raster that is to be copied.
struct RasterPart {
  std::string dataset;
  PixelWindow window;
  GeoTransform map_from_pixel;  ///< Of the whole raster, as inspect_imagery found it.
  Crs crs;
  std::vector<std::pair<std::string, std::string>> tags;  ///< Besides those of the raster.
};

inline constexpr std::int64_t kStripBytes = std::int64_t{16} << 20;

/// Copies it as it is stored, all bands, mask, colours and no-data value, into a Cloud-Optimised GeoTIFF at `path`
/// (deflated, lossless). Rows are read in strips of some `strip_bytes`, whole rows of the raster's blocks, that stand
/// in `strips`, a folder, until the file is whole: what was read before an interruption is not read again. The caller
/// sees to it that strips there are of this raster and window, and removes them. The disk holds the part up to three
/// times meanwhile. Throws DataError when something cannot be read or written, the window does not lie in the raster,
/// or its bands are of different types, no-data values or masks, which a GeoTIFF does not hold; Interrupted.
void copy_raster_part(const RasterPart& part, const std::filesystem::path& path, const std::filesystem::path& strips,
                      const Progress& progress = {}, std::int64_t strip_bytes = kStripBytes);

}  // namespace pilotage
