#include <string>
#include <string_view>

#include "completion.h"
#include "completion_model.h"

#include "pilotage/base/text.h"

namespace pilotage {
namespace {

constexpr const char* kFishFunctions = R"(# fish completion for pilotage, written by `pilotage completion fish`.

function __pilotage_needs_command
    test (count (commandline -opc)) -eq 1
end

function __pilotage_is
    set -l words (commandline -opc)
    test (count $words) -gt 1; and test $words[2] = $argv[1]
end

complete -c pilotage -n __pilotage_needs_command -f
complete -c pilotage -n __pilotage_needs_command -s h -l help -d 'List the commands.'
complete -c pilotage -n __pilotage_needs_command -l version -d 'Print the version.'
)";

std::string in_quotes(std::string_view text) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'' || c == '\\') result += '\\';
    result += c;
  }
  return result + "'";
}

std::string value_of(const CompletionFlag& flag) {
  switch (flag.value) {
    case ValueKind::kNone:
      return "";
    case ValueKind::kFile:
      return " -r -F";
    case ValueKind::kFolder:
      return " -x -a '(__fish_complete_directories)'";
    case ValueKind::kChoice:
      return " -x -a " + in_quotes(join(flag.choices, " "));
    case ValueKind::kChoices:
      return " -x -a '(__fish_append , " + join(flag.choices, " ") + ")'";
    default:
      return " -x";
  }
}

}  // namespace

std::string fish_completion(const std::vector<Command>& commands) {
  std::string script = kFishFunctions;
  for (const CompletionCommand& command : completion_model(commands)) {
    script += "\ncomplete -c pilotage -n __pilotage_needs_command -a " + command.word + " -d " +
              in_quotes(command.summary) + "\n";
    const std::string head = "complete -c pilotage -n '__pilotage_is " + command.word + "'";
    if (!command.takes_inputs) script += head + " -f\n";
    if (!command.input_choices.empty()) script += head + " -f -a " + in_quotes(join(command.input_choices, " ")) + "\n";
    for (const CompletionFlag& flag : command.flags) {
      script += head + (flag.letter.empty() ? "" : " -s " + flag.letter) + " -l " + flag.flag + value_of(flag) +
                " -d " + in_quotes(flag.help) + "\n";
    }
  }
  return script;
}

}  // namespace pilotage
