#include "pilotage/base/read_file.h"

#include <fstream>
#include <system_error>

#include "pilotage/base/error.h"

namespace pilotage {

namespace fs = std::filesystem;

std::string read_file(const fs::path& path, std::uintmax_t max_bytes) {
  std::error_code error;
  if (fs::is_directory(path, error)) throw DataError(path.string() + ": is a folder, not a file");
  const std::uintmax_t size = fs::file_size(path, error);
  if (error) throw DataError(path.string() + ": cannot be read: " + error.message());
  if (size > max_bytes) {
    throw DataError(path.string() + ": has " + std::to_string(size) + " bytes, at most " + std::to_string(max_bytes) +
                    " are allowed");
  }
  std::string content(size, '\0');
  std::ifstream stream(path, std::ios::binary);
  stream.read(content.data(), static_cast<std::streamsize>(size));
  if (!stream) throw DataError(path.string() + ": cannot be read");
  return content;
}

}  // namespace pilotage
