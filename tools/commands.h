#pragma once

#include "command.h"

// One function for each command, by the way of the data; command_<word>.cc defines it and main.cc lists it.

namespace pilotage {}  // namespace pilotage
