#pragma once

#include <filesystem>
#include <string>

namespace pilotage {

/// The tag (GDAL metadata) by which a raster of imagery names the raster of its own error, a file in the same folder:
/// its first band holds the standard deviation of where the imagery lies, each axis, in metres.
inline constexpr const char* kMapSigmaTag = "PILOTAGE_MAP_SIGMA";

/// reference.tif: reference.map_sigma.tif.
std::filesystem::path map_sigma_path(const std::filesystem::path& imagery);

/// The file that `tag` of a dataset names. Throws DataError when it is no name of a file in one folder.
std::string map_sigma_beside(const std::string& dataset, const std::string& tag);

}  // namespace pilotage
