#pragma once

#include <string>
#include <vector>

#include "command.h"

namespace pilotage {

/// Shell scripts that complete a `pilotage` command line: words of commands, flags, the allowed names of a flag (for
/// lists also after a comma), files and folders. They are written from the described options of `commands` and hold
/// all of them, so that no program is started while somebody types.

/// For bash 4.4 and later; needs no other file of the bash-completion package.
std::string bash_completion(const std::vector<Command>& commands);

/// For zsh: an autoloaded function `_pilotage`, or sourced after compinit.
std::string zsh_completion(const std::vector<Command>& commands);

/// For fish 3.
std::string fish_completion(const std::vector<Command>& commands);

}  // namespace pilotage
