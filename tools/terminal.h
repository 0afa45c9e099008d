#pragma once

#include <iosfwd>

#include "progress_meter.h"

namespace pilotage {

/// Standard output or standard error, and a terminal.
bool is_terminal(const std::ostream& stream);

/// A meter for standard error: a bar only when `stream` is std::cerr and that is a terminal.
ProgressMeter make_progress_meter(ProgressMode mode, std::ostream& stream);

/// Colours are for terminals that understand them (standard output or standard error), and for people who have not set
/// NO_COLOR (no-color.org). CLICOLOR_FORCE asks for them on anything.
bool wants_colour(const std::ostream& stream);

}  // namespace pilotage
