#pragma once

#include <string>
#include <vector>

#include "command.h"

namespace pilotage {

/// A page of the manual, section 1, in the macros of man(7). No dates: the same program writes the same bytes.
struct ManualPage {
  std::string file;  ///< "pilotage-score.1"
  std::string text;
};

/// pilotage.1: what the program is, its commands by the way of the data, exit codes and environment.
ManualPage manual_of_program(const std::vector<Command>& commands, const std::string& version);

/// pilotage-<word>.1: usage, examples, inputs, output and every option with unit, range and default.
ManualPage manual_of_command(const Command& command, const std::string& version);

/// The tables of options that docs/commands/<word>.md holds (Markdown).
std::string option_tables(const Command& command);

}  // namespace pilotage
