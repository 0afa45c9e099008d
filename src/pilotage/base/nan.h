#pragma once

#include <limits>

namespace pilotage {

/// What a number is that is not known or not there.
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

}  // namespace pilotage
