#pragma once

#include <string>
#include <vector>

#include "command.h"

namespace pilotage {

/// What `pilotage --help` says: the commands by the way of the data. Fits a screen of 24 lines of 80 characters.
std::string overview_help(const std::vector<Command>& commands);

/// Commands with more options than this have a short help, too.
inline constexpr std::size_t kManyOptions = 40;

/// What `pilotage <word> --help` says, in lines of at most 80 characters. `common`: the flags every command takes. Of a
/// command with many options groups are only named, unless `all` is asked for (`--help all`).
std::string command_help(const Command& command, const OptionList& common, bool all);

}  // namespace pilotage
