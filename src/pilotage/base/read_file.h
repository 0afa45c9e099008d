#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#pragma GCC visibility push(default)

namespace pilotage {

/// All bytes of a file. Throws DataError when it cannot be read whole, is no regular file, or is larger than
/// `max_bytes`.
std::string read_file(const std::filesystem::path& path, std::uintmax_t max_bytes = std::uintmax_t{1} << 30);

}  // namespace pilotage

#pragma GCC visibility pop
