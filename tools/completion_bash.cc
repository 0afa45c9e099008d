#include <string>

#include "completion.h"
#include "completion_model.h"

#include "pilotage/base/text.h"

namespace pilotage {
namespace {

// What does not depend on the commands. bash splits "--flag=value" at "=", and cuts what it inserts in the same way.
constexpr const char* kBashFunctions = R"(
# Answers with the words that begin with what is typed.
_pilotage_words() {
  local word
  for word in "$@"; do
    if [[ $word == "$cur"* ]]; then COMPREPLY+=("$word"); fi
  done
}

# A list with commas: what stands before the last comma stays, and is not offered again.
_pilotage_list() {
  local given='' last=$cur word
  if [[ $cur == *,* ]]; then
    given=${cur%,*},
    last=${cur##*,}
  fi
  compopt -o nospace 2>/dev/null
  for word in "$@"; do
    if [[ $word == "$last"* && ,$given != *",$word,"* ]]; then COMPREPLY+=("$given$word"); fi
  done
}

_pilotage_paths() {
  compopt -o filenames 2>/dev/null
  local path
  while IFS= read -r path; do
    COMPREPLY+=("$path")
  done < <(compgen "$1" -- "$cur")
}

_pilotage() {
  local cur=${COMP_WORDS[COMP_CWORD]} before='' word=${COMP_WORDS[1]-} i
  COMPREPLY=()
  if ((COMP_CWORD == 1)); then
    _pilotage_words $(_pilotage_commands) --help --version
    return
  fi
  before=${COMP_WORDS[COMP_CWORD - 1]}
  if [[ $cur == = ]]; then
    cur=''
  elif [[ $before == = ]]; then
    before=${COMP_WORDS[COMP_CWORD - 2]}
  fi
  for ((i = 2; i < COMP_CWORD; ++i)); do
    if [[ ${COMP_WORDS[i]} == -- ]]; then  # only inputs from here on
      _pilotage_input "$word"
      return
    fi
  done
  if [[ $before == -* ]] && _pilotage_value "$word" "$before"; then
    return
  fi
  if [[ $cur == -* ]]; then
    _pilotage_words $(_pilotage_flags "$word")
  else
    _pilotage_input "$word"
  fi
}

complete -F _pilotage pilotage
)";

std::string bash_action_of(const CompletionFlag& flag) {
  switch (flag.value) {
    case ValueKind::kFile:
      return "_pilotage_paths -f";
    case ValueKind::kFolder:
      return "_pilotage_paths -d";
    case ValueKind::kChoice:
      return "_pilotage_words " + join(flag.choices, " ");
    case ValueKind::kChoices:
      return "_pilotage_list " + join(flag.choices, " ");
    default:
      return ":";
  }
}

std::string flags_of(const CompletionCommand& command) {
  std::string flags;
  for (const CompletionFlag& flag : command.flags) flags += " --" + flag.flag;
  return flags.empty() ? "" : flags.substr(1);
}

// One line for each flag that takes a value.
std::string values_of(const CompletionCommand& command) {
  std::string lines;
  for (const CompletionFlag& flag : command.flags) {
    if (flag.value == ValueKind::kNone) continue;
    const std::string letter = flag.letter.empty() ? "" : " | '" + command.word + " -" + flag.letter + "'";
    lines += "    '" + command.word + " --" + flag.flag + "'" + letter + ") " + bash_action_of(flag) + " ;;\n";
  }
  return lines;
}

std::string bash_input_of(const CompletionCommand& command) {
  if (!command.takes_inputs) return ":";
  if (command.input_choices.empty()) return "_pilotage_paths -f";
  return "_pilotage_words " + join(command.input_choices, " ");
}

}  // namespace

std::string bash_completion(const std::vector<Command>& commands) {
  std::string words;
  std::string flags;
  std::string values;
  std::string inputs;
  for (const CompletionCommand& command : completion_model(commands)) {
    words += (words.empty() ? "" : " ") + command.word;
    flags += "    " + command.word + ") echo '" + flags_of(command) + "' ;;\n";
    values += values_of(command);
    inputs += "    " + command.word + ") " + bash_input_of(command) + " ;;\n";
  }
  return "# bash completion for pilotage, written by `pilotage completion bash`.\n# shellcheck shell=bash "
         "disable=SC2046\n\n_pilotage_commands() {\n  echo '" +
         words + "'\n}\n\n_pilotage_flags() {\n  case $1 in\n" + flags +
         "  esac\n}\n\n# Fails when the flag takes no value.\n_pilotage_value() {\n  case \"$1 $2\" in\n" + values +
         "    *) return 1 ;;\n  esac\n}\n\n_pilotage_input() {\n  case $1 in\n" + inputs + "  esac\n}\n" +
         kBashFunctions;
}

}  // namespace pilotage
