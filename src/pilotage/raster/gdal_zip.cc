#include "pilotage/raster/gdal_zip.h"

#include <atomic>

#include <cpl_conv.h>
#include <cpl_vsi.h>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/raster/gdal_handle.h"

namespace pilotage {

namespace {

/// A file of GDAL's memory file system, gone with the object.
class MemoryFile {
 public:
  MemoryFile() {
    static std::atomic<unsigned> counter{0};
    path_ = "/vsimem/pilotage-zip-" + std::to_string(counter++) + ".zip";
  }
  ~MemoryFile() { VSIUnlink(path_.c_str()); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  const std::string& path() const { return path_; }
  std::string_view bytes() const {
    vsi_l_offset size = 0;
    const GByte* data = VSIGetMemFileBuffer(path_.c_str(), &size, FALSE);
    return {reinterpret_cast<const char*>(data), data == nullptr ? 0 : static_cast<std::size_t>(size)};
  }

 private:
  std::string path_;
};

}  // namespace

void write_zip(const std::filesystem::path& path, const std::vector<std::pair<std::string, std::string>>& files,
               bool overwrite) {
  const GdalErrors errors;
  // In memory first: GDAL forgets a write that a disk cut short.
  const MemoryFile archive;
  void* zip = CPLCreateZip(archive.path().c_str(), nullptr);
  bool whole = zip != nullptr;
  for (const auto& [name, content] : files) {
    if (!whole) break;
    whole = CPLCreateFileInZip(zip, name.c_str(), nullptr) == CE_None &&
            CPLWriteFileInZip(zip, content.data(), static_cast<int>(content.size())) == CE_None &&
            CPLCloseFileInZip(zip) == CE_None;
  }
  if (zip != nullptr) whole = CPLCloseZip(zip) == CE_None && whole;
  if (!whole || errors.failed()) errors.throw_data_error(path.string() + ": cannot be written");
  write_file(path, archive.bytes(), overwrite);
}

}  // namespace pilotage
