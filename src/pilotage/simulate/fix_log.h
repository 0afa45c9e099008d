#pragma once

#include <span>
#include <string>

#include "pilotage/simulate/rendered_fixes.h"

namespace pilotage {

/// The tries of simulated flights as fixes.csv (schemas/fixes-csv.md), without times, with the columns of simulated
/// tries after the others.
std::string fix_log_to_csv(std::span<const SimulatedTry> tries);

}  // namespace pilotage
