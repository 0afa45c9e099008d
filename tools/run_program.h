#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "command.h"

namespace pilotage {

/// Runs `pilotage` with `arguments` (argv without the program's name): finds the command, reads the configuration file
/// and the flags into its options, runs it and prints what it has to say. Results go to `out`, everything else to
/// `err`. Returns the exit code; throws nothing.
int run_program(std::vector<Command> commands, const std::vector<std::string>& arguments, std::ostream& out,
                std::ostream& err);

}  // namespace pilotage
