#include "commands.h"
#include "completion.h"

#include "pilotage/base/output_file.h"

namespace pilotage {
namespace {

std::string script_for(const std::string& shell, const std::vector<Command>& commands) {
  if (shell == "bash") return bash_completion(commands);
  if (shell == "zsh") return zsh_completion(commands);
  return fish_completion(commands);
}

CommandResult run_completion(const Invocation& invocation) {
  const std::string& shell = invocation.inputs.front();
  const std::string script = script_for(shell, *invocation.commands);
  CommandResult result;
  result.json = {{"shell", shell}};
  if (invocation.output.empty()) {
    result.text = script;
    result.json["script"] = script;
  } else {
    write_file(invocation.output, script, invocation.overwrite);
    result.json["output"] = invocation.output;
  }
  return result;
}

}  // namespace

Command make_completion_command() {
  Command command;
  command.word = "completion";
  command.group = CommandGroup::kHelp;
  command.summary = "Print a script that completes command lines in a shell";
  command.examples = {
      {"In this bash; in every bash with this line in ~/.bashrc.", "source <(pilotage completion bash)"},
      {"For zsh, into a folder of its fpath.", "pilotage completion zsh -o ~/.zfunc/_pilotage"},
      {"For fish, once and for all.", "pilotage completion fish -o ~/.config/fish/completions/pilotage.fish"}};
  command.inputs = {
      .name = "SHELL", .help = "bash, zsh or fish.", .min = 1, .max = 1, .choices = {"bash", "zsh", "fish"}};
  command.output = {.kind = OutputKind::kFile, .help = "Write the script here and print nothing.", .required = false};
  command.run = run_completion;
  return command;
}

}  // namespace pilotage
