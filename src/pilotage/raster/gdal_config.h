#pragma once

#include <string>

namespace pilotage {

/// Sets one of GDAL's configuration options for the whole process, "KEY=VALUE" (for example "GDAL_CACHEMAX=256").
/// Call it before any other thread uses GDAL. Throws UsageError when `key_value` has no key or no "=".
void set_gdal_config(const std::string& key_value);

/// The version of the GDAL library in use, "3.6.2".
std::string gdal_version();

}  // namespace pilotage
