#include "pilotage/route/ogr_memory_file.h"

#include <atomic>

#include <cpl_vsi.h>

namespace pilotage {

OgrMemoryFile::OgrMemoryFile(std::string_view bytes, const std::string& extension) : copy_(bytes.begin(), bytes.end()) {
  static std::atomic<unsigned> counter{0};
  // OGR calls a layer without a name like the file; so all are called the same.
  path_ = "/vsimem/pilotage-route-" + std::to_string(counter++) + "/doc." + extension;
  VSIFCloseL(VSIFileFromMemBuffer(path_.c_str(), copy_.data(), copy_.size(), FALSE));
}

OgrMemoryFile::~OgrMemoryFile() {
  VSIUnlink(path_.c_str());
}

}  // namespace pilotage
