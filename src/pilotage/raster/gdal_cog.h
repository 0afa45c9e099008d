#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pilotage/base/progress.h"

class GDALDataset;

// Private to raster/gdal_*.cc.

namespace pilotage {

/// Writes a Cloud-Optimised GeoTIFF of a dataset with these creation options of GDAL's driver COG. What stands at
/// `path` then is whole, or an exception was thrown; nothing stands beside it. `name`: the file, for messages. Throws
/// DataError, Interrupted.
void make_cog(GDALDataset& source, const std::filesystem::path& path, const std::string& name,
              const std::vector<std::string>& options, const Progress& progress);

}  // namespace pilotage
