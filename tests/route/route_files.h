#pragma once

#include <filesystem>
#include <string>

#include "testing/error_of.h"
#include "testing/source_folder.h"

#include "pilotage/route/read_route.h"

namespace pilotage::testing {

inline std::filesystem::path route_file(const std::string& name) {
  return testing::source_folder() / "tests" / "data" / "routes" / name;
}

/// The message of the DataError or UsageError that reading the text throws, "" when it throws none.
inline std::string route_error(const std::string& text, const RouteOptions& options = {}) {
  return error_of<std::runtime_error>([&] { parse_route("r", text, options); });
}

inline std::string route_file_error(const std::filesystem::path& path, const RouteOptions& options = {}) {
  return error_of<std::runtime_error>([&] { read_route(path, options); });
}

}  // namespace pilotage::testing
