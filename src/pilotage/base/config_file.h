#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "pilotage/base/options.h"

namespace pilotage {

/// Where a path that stands in a configuration file in `folder` leads. A relative path that exists beside the
/// configuration file means that file; everything else is left as it is: absolute paths, GDAL dataset strings
/// ("/vsicurl/https://…", "NETCDF:a.nc:band", "WMS:…"), and relative paths that do not exist there, which are relative
/// to the working folder. So a mission folder can be moved, and what --print-config shows can be saved anywhere.
std::string path_beside(const std::string& path, const std::filesystem::path& folder);

/// Reads a configuration file (strict JSON, base/options_json.h) into the fields of `list`; fields that are paths go
/// through path_beside(). Throws DataError when the file cannot be read or is not JSON, UsageError when a key or a
/// value is not allowed.
void load_config_file(const OptionList& list, const std::filesystem::path& file);

/// The same of the text of a configuration file that would stand in `folder`; `name` stands in messages.
void load_config(const OptionList& list, const std::string& name, std::string_view text,
                 const std::filesystem::path& folder);

/// Largest configuration file that is read.
inline constexpr std::uintmax_t kMaxConfigBytes = std::uintmax_t{16} << 20;

}  // namespace pilotage
