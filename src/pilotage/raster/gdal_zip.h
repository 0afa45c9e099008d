#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace pilotage {

/// Writes a ZIP archive of files by name and content, in this order, deflated and without dates, so that the same input
/// gives the same bytes. Throws DataError when the archive exists and `overwrite` is false, or cannot be written.
void write_zip(const std::filesystem::path& path, const std::vector<std::pair<std::string, std::string>>& files,
               bool overwrite);

}  // namespace pilotage
