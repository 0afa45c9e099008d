#pragma once

#include <vector>

#include "command.h"
#include <nlohmann/json_fwd.hpp>

namespace pilotage {

/// What every command takes, for programs that offer them to their own users (schemas/commands.schema.json): inputs,
/// output, and each option with its flag, type, unit, limits and default. Options that only a configuration file may
/// hold are left out, and the commands of CommandGroup::kHelp, which say something of the program itself.
nlohmann::ordered_json describe_commands(const std::vector<Command>& commands);

}  // namespace pilotage
