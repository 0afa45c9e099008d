#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace pilotage {

/// BLAKE2b-256 of bytes as 64 hex digits (RFC 7693; libsodium): what `b2sum -l 256` prints.
std::string bytes_digest(std::string_view bytes);

/// The same of a file's bytes. Reads in pieces of 1 MiB. Throws DataError when it cannot be
/// read to the end that its size tells.
std::string file_digest(const std::filesystem::path& path);

}  // namespace pilotage
