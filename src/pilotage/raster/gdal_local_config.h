#pragma once

#include <cpl_conv.h>

// Private to raster/gdal_*.cc.

namespace pilotage {

/// A GDAL configuration option of this thread while it lives.
class LocalConfig {
 public:
  LocalConfig(const char* key, const char* value) : key_(key) { CPLSetThreadLocalConfigOption(key, value); }
  ~LocalConfig() { CPLSetThreadLocalConfigOption(key_, nullptr); }
  LocalConfig(const LocalConfig&) = delete;
  LocalConfig& operator=(const LocalConfig&) = delete;

 private:
  const char* key_;
};

}  // namespace pilotage
