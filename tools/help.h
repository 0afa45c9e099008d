#pragma once

#include <string>
#include <vector>

#include "command.h"

namespace pilotage {

/// What `pilotage --help` says: the commands by the way of the data. Fits a screen of 24 lines of 80 characters.
std::string overview_help(const std::vector<Command>& commands);

/// What `pilotage <word> --help` says, in lines of at most 80 characters. `common`: the flags every command takes.
std::string command_help(const Command& command, const OptionList& common);

/// Breaks `text` at blanks into lines of at most `width` characters (UTF-8), each after `indent` blanks.
std::string wrap_text(const std::string& text, std::size_t indent, std::size_t width = 80);

}  // namespace pilotage
