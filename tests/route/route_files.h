#pragma once

#include <filesystem>
#include <string>

#include "pilotage/base/error.h"
#include "pilotage/route/read_route.h"

namespace pilotage::testing {

inline std::filesystem::path route_file(const std::string& name) {
  return std::filesystem::path(PILOTAGE_SOURCE_DIR) / "tests" / "data" / "routes" / name;
}

/// The message of the DataError or UsageError that reading the text throws, "" when it throws none.
inline std::string route_error(const std::string& text, const RouteOptions& options = {}) {
  try {
    parse_route("r", text, options);
  } catch (const DataError& error) {
    return error.what();
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

inline std::string route_file_error(const std::filesystem::path& path, const RouteOptions& options = {}) {
  try {
    read_route(path, options);
  } catch (const DataError& error) {
    return error.what();
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

}  // namespace pilotage::testing
