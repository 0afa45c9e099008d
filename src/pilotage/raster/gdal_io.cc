#include "pilotage/raster/gdal_io.h"

#include <cctype>
#include <string>
#include <vector>

#include <cpl_conv.h>

#include "pilotage/base/error.h"

namespace pilotage {

void set_gdal_config(const std::vector<std::string>& key_values) {
  for (const std::string& text : key_values) {
    const auto split = text.find('=');
    if (split == std::string::npos || split == 0) {
      throw UsageError("gdal config \"" + text + "\" is not KEY=VALUE, for instance GDAL_HTTP_TIMEOUT=30");
    }
    CPLSetConfigOption(text.substr(0, split).c_str(), text.substr(split + 1).c_str());
  }
}

}  // namespace pilotage
