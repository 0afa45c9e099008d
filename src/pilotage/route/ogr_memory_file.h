#pragma once

#include <string>
#include <string_view>
#include <vector>

// Private to route/ogr_*.cc.

namespace pilotage {

/// The bytes as a file of GDAL's memory file system, gone with the object.
class OgrMemoryFile {
 public:
  OgrMemoryFile(std::string_view bytes, const std::string& extension);
  ~OgrMemoryFile();
  OgrMemoryFile(const OgrMemoryFile&) = delete;
  OgrMemoryFile& operator=(const OgrMemoryFile&) = delete;

  const std::string& path() const { return path_; }

 private:
  std::string path_;
  std::vector<unsigned char> copy_;
};

}  // namespace pilotage
