#pragma once

#include <string>

namespace pilotage {

/// "pilotage 0.1.0" and, on the following lines, the libraries in use.
std::string version_text();

}  // namespace pilotage
