#include "pilotage/raster/map_sigma.h"

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/base/utf8.h"

namespace pilotage {

std::filesystem::path map_sigma_path(const std::filesystem::path& imagery) {
  const std::string extension = imagery.extension().string();
  std::filesystem::path path = imagery;
  if (extension == ".tif" || extension == ".tiff" || extension == ".TIF" || extension == ".TIFF")
    path.replace_extension();
  path += ".map_sigma.tif";
  return path;
}

std::string map_sigma_beside(const std::string& dataset, const std::string& tag) {
  const std::filesystem::path name(tag);
  if (name.filename() != name || tag == "." || tag == "..") {
    throw DataError(dataset + ": its tag " + kMapSigmaTag + " = \"" + name_as_utf8(tag) +
                    "\" is no name of a file in its folder");
  }
  return (std::filesystem::path(dataset).parent_path() / name).string();
}

}  // namespace pilotage
