#include "pilotage/raster/gdal_zip.h"

#include <memory>

#include <cpl_conv.h>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/raster/gdal_handle.h"

namespace pilotage {

void write_zip(const std::filesystem::path& path, const std::vector<std::pair<std::string, std::string>>& files,
               bool overwrite) {
  const GdalErrors errors;
  OutputFile output(path, overwrite);
  void* zip = CPLCreateZip(output.temporary_path().c_str(), nullptr);
  bool whole = zip != nullptr;
  for (const auto& [name, content] : files) {
    if (!whole) break;
    whole = CPLCreateFileInZip(zip, name.c_str(), nullptr) == CE_None &&
            CPLWriteFileInZip(zip, content.data(), static_cast<int>(content.size())) == CE_None &&
            CPLCloseFileInZip(zip) == CE_None;
  }
  if (zip != nullptr) whole = CPLCloseZip(zip) == CE_None && whole;
  if (!whole || errors.failed()) errors.throw_data_error(path.string() + ": cannot be written");
  output.commit();
}

}  // namespace pilotage
