#include <string>
#include <string_view>

#include "completion.h"
#include "completion_model.h"

#include "pilotage/base/text.h"

namespace pilotage {
namespace {

std::string escaped(std::string_view text, std::string_view special) {
  std::string result;
  for (const char c : text) {
    if (c == '\'') {
      result += "'\\''";
      continue;
    }
    if (c == '\\' || special.find(c) != std::string_view::npos) result += '\\';
    result += c;
  }
  return result;
}

std::string zsh_action_of(const CompletionFlag& flag) {
  switch (flag.value) {
    case ValueKind::kFile:
      return "_files";
    case ValueKind::kFolder:
      return "_files -/";
    case ValueKind::kChoice:
      return "(" + join(flag.choices, " ") + ")";
    case ValueKind::kChoices:
      return "_values -s , " + flag.value_name + " " + join(flag.choices, " ");
    default:
      return " ";
  }
}

// '*--imagery=[Rasters.]:PATH:_files', and the same for the letter.
std::string specs_of(const CompletionFlag& flag) {
  const std::string star = flag.repeated ? "*" : "";
  const std::string help = "[" + escaped(flag.help, "[]") + "]";
  const bool takes_value = flag.value != ValueKind::kNone;
  const std::string value = takes_value ? ":" + flag.value_name + ":" + zsh_action_of(flag) : "";
  std::string specs = "'" + star + "--" + flag.flag + (takes_value ? "=" : "") + help + value + "'";
  if (!flag.letter.empty()) specs += " '" + star + "-" + flag.letter + help + value + "'";
  return specs;
}

std::string zsh_input_of(const CompletionCommand& command) {
  if (!command.takes_inputs) return "";
  const std::string action = command.input_choices.empty() ? "_files" : "(" + join(command.input_choices, " ") + ")";
  return " \\\n        '*:" + escaped(command.input_name, ":") + ":" + action + "'";
}

}  // namespace

std::string zsh_completion(const std::vector<Command>& commands) {
  std::string described;
  std::string cases;
  for (const CompletionCommand& command : completion_model(commands)) {
    described += "    '" + command.word + ":" + escaped(command.summary, ":") + "'\n";
    cases += "    " + command.word + ")\n      _arguments -S";
    for (const CompletionFlag& flag : command.flags) cases += " \\\n        " + specs_of(flag);
    cases += zsh_input_of(command) + "\n      ;;\n";
  }
  return "#compdef pilotage\n# zsh completion for pilotage, written by `pilotage completion zsh`.\n\n_pilotage() {\n"
         "  local curcontext=$curcontext\n  local -a commands\n  commands=(\n" +
         described +
         "  )\n  if ((CURRENT == 2)); then\n    _describe -t commands 'command of pilotage' commands\n"
         "    _arguments '(- *)'{-h,--help}'[List the commands.]' '(- *)--version[Print the version.]'\n    return\n"
         "  fi\n  local word=$words[2]\n  shift words\n  ((CURRENT -= 1))\n  case $word in\n" +
         cases +
         "  esac\n}\n\n# Run as an autoloaded function it completes; sourced it says what it completes.\n"
         "if [[ $funcstack[1] == _pilotage ]]; then\n  _pilotage \"$@\"\nelse\n  compdef _pilotage pilotage\nfi\n";
}

}  // namespace pilotage
