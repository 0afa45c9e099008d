#pragma once

#include <cstddef>
#include <string>

namespace pilotage {

/// All bytes of a file that GDAL's file systems reach ("a.json", "/vsicurl/https://…", "/vsizip/…"), as far as they are
/// allowed (gdal_access.h). Throws DataError, naming it, when it cannot be read or has more than `max_bytes`.
std::string read_gdal_text(const std::string& name, std::size_t max_bytes);

}  // namespace pilotage
