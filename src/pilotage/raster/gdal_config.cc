#include "pilotage/raster/gdal_config.h"

#include <cpl_conv.h>
#include <gdal.h>

#include "pilotage/base/error.h"

namespace pilotage {

void set_gdal_config(const std::string& key_value) {
  const auto equals = key_value.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw UsageError("gdal_config = \"" + key_value + "\" is not of the form KEY=VALUE");
  }
  CPLSetConfigOption(key_value.substr(0, equals).c_str(), key_value.substr(equals + 1).c_str());
}

std::string gdal_version() {
  return GDALVersionInfo("RELEASE_NAME");
}

}  // namespace pilotage
