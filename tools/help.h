#pragma once

#include <string>
#include <vector>

#include "command.h"

namespace pilotage {

/// What `pilotage --help` says: the commands by the way of the data. Fits a screen of 24 lines of 80 characters.
std::string overview_help(const std::vector<Command>& commands);

/// What `pilotage <word> --help` says, in lines of at most 80 characters. `common`: the flags every command takes.
std::string command_help(const Command& command, const OptionList& common);

}  // namespace pilotage
