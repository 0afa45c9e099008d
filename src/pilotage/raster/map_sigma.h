#pragma once

#include <filesystem>

namespace pilotage {

/// The tag (GDAL metadata) by which a raster of imagery names the raster of its own error, a file in the same folder:
/// band 1 holds the standard deviation of its place, each axis, in metres.
inline constexpr const char* kMapSigmaTag = "PILOTAGE_MAP_SIGMA";

/// reference.tif: reference.map_sigma.tif.
inline std::filesystem::path map_sigma_path(std::filesystem::path imagery) {
  return imagery.replace_extension(".map_sigma.tif");
}

}  // namespace pilotage
