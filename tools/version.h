#pragma once

#include <string>

namespace pilotage {

/// "pilotage 0.2.0"
std::string version_line();

/// version_line() and, on the following lines, the commit, how it was compiled and the libraries in use.
std::string version_text();

}  // namespace pilotage
