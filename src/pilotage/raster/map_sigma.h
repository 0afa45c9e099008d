#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pilotage/raster/gdal_crs.h"
#include "pilotage/raster/gray_source.h"

namespace pilotage {

/// The tag (GDAL metadata) by which a raster of imagery names the raster of its own error, a file in the same folder:
/// its first band holds the standard deviation of where the imagery lies, each axis, in metres.
inline constexpr const char* kMapSigmaTag = "PILOTAGE_MAP_SIGMA";

/// reference.tif: reference.map_sigma.tif.
std::filesystem::path map_sigma_path(const std::filesystem::path& imagery);

/// Whether there is such a file; of what GDAL opens in archives and over networks it is believed.
bool map_sigma_exists(const std::string& raster);

/// Larger errors that a map says of itself count as this.
inline constexpr double kLargestSaidSigma_m = 100;

/// The first bands of such rasters on a grid, later ones on top. Throws as open_gray_on_grid.
GraySource open_map_sigma(const std::vector<std::string>& rasters, const Crs& crs, const GeoTransform& map_from_pixel,
                          std::int64_t width_px, std::int64_t height_px);

/// Root mean square of the valid pixels of what open_map_sigma() gave; nothing without any; at most
/// kLargestSaidSigma_m. Throws DataError, beginning with `names`, for a negative one.
std::optional<double> mean_map_sigma_m(const Raster& sigmas_m, const std::string& names);

}  // namespace pilotage
