#pragma once

#include <filesystem>
#include <string>

namespace pilotage {

/// BLAKE2b-256 of a file's bytes as 64 hex digits (RFC 7693; libsodium). Reads in pieces of 1 MiB. Throws DataError
/// when it cannot be read.
std::string file_digest(const std::filesystem::path& path);

}  // namespace pilotage
