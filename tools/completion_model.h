#pragma once

#include <string>
#include <vector>

#include "command.h"

namespace pilotage {

/// What a shell may offer for one value.
enum class ValueKind { kNone, kAny, kFile, kFolder, kChoice, kChoices };

/// One flag as the shells see it.
struct CompletionFlag {
  std::string letter;  ///< "o", or "".
  std::string flag;    ///< "output"; of a boolean that is on by default "no-check".
  std::string help;
  std::string value_name;             ///< "PATH"
  ValueKind value = ValueKind::kAny;  ///< kNone: takes no value. kChoices: several, joined by commas.
  std::vector<std::string> choices;
  bool repeated = false;  ///< Given several times, each time adds.
};

struct CompletionCommand {
  std::string word;
  std::string summary;
  std::vector<CompletionFlag> flags;  ///< With the common ones, --help and --version.
  bool takes_inputs = false;
  std::string input_name;
  std::vector<std::string> input_choices;  ///< Empty: files.
};

/// The commands with all their flags; the word "help", which run_program() knows, is one of them.
std::vector<CompletionCommand> completion_model(const std::vector<Command>& commands);

}  // namespace pilotage
