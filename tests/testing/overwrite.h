#pragma once

#include <filesystem>
#include <fstream>
#include <string>

namespace pilotage::testing {

/// Writes a file in its place and waits for no disk: for tests that write one a thousand times.
inline void overwrite(const std::filesystem::path& path, const std::string& content) {
  std::ofstream(path, std::ios::binary).write(content.data(), static_cast<std::streamsize>(content.size()));
}

}  // namespace pilotage::testing
