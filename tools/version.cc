#include "version.h"

#include "pilotage_revision.h"
#include <opencv2/core/utility.hpp>
#include <sqlite3.h>

#include "pilotage/raster/gdal_config.h"
#include "pilotage/version.h"

namespace pilotage {

std::string version_line() {
  return std::string("pilotage ") + PILOTAGE_VERSION;
}

std::string version_text() {
  return version_line() + "\nrevision " + PILOTAGE_REVISION + "\nbuild " + PILOTAGE_BUILD + "\nGDAL " + gdal_version() +
         "\nOpenCV " + cv::getVersionString() + "\nSQLite " + sqlite3_libversion() + "\n";
}

}  // namespace pilotage
