#pragma once

#include <string>
#include <utility>
#include <vector>

#include "pilotage/base/options.h"

namespace pilotage {

/// What stands on a command line after the command's word, not yet converted.
struct ParsedLine {
  /// Flag without dashes → values as typed, in the order of the fields; only flags that were given. A boolean has one
  /// value, "true" or "false": the last one given.
  std::vector<std::pair<std::string, std::vector<std::string>>> flags;
  std::vector<std::string> inputs;
  bool help = false;
  bool version = false;
};

/// Of these options, and all of these groups (dotted paths), only a configuration file may speak: they get no flags.
/// For what another command with the same file uses and this one does not.
void take_flags_away(OptionList& options, const std::vector<std::string>& paths);

/// Splits a command line by the flags of `lists`:
///   --flag VALUE, --flag=VALUE; lists: several values joined by commas, or the flag repeated (lists of paths: only
///   repeated); booleans: --flag, --no-flag, --flag=true|false; "--" ends the flags.
/// Throws UsageError for an unknown flag (with the nearest known one) and for a flag without its value. Values are not
/// looked at: apply_flags() does.
ParsedLine parse_line(const std::vector<const OptionList*>& lists, const std::vector<std::string>& arguments);

/// Writes the flags that belong to `list` into its fields. Throws UsageError that names the flag as it is typed.
void apply_flags(const OptionList& list, const ParsedLine& line);

}  // namespace pilotage
