#include "completion_model.h"

#include <algorithm>

#include "common_options.h"
#include "option_text.h"

namespace pilotage {
namespace {

ValueKind kind_of(const Command& command, const OptionField& field) {
  if (field.type == OptionType::kBool) return ValueKind::kNone;
  if (field.flag == "gdal-config") return ValueKind::kAny;
  if (field.flag == "output" && command.output.kind == OutputKind::kFolder) return ValueKind::kFolder;
  if (field.is_path) return ValueKind::kFile;
  if (field.choices.empty()) return ValueKind::kAny;
  return field.type == OptionType::kStringList ? ValueKind::kChoices : ValueKind::kChoice;
}

CompletionFlag flag_of(const Command& command, const OptionField& field) {
  const OptionEntry entry = describe_option(field);
  const bool is_list = field.type == OptionType::kStringList || field.type == OptionType::kNumberList;
  return {entry.letter.empty() ? "" : entry.letter.substr(1),
          entry.flag.substr(2),
          entry.help,
          entry.value,
          kind_of(command, field),
          field.choices,
          is_list};
}

CompletionCommand describe(const Command& command) {
  CommonOptions common;
  const OptionList common_fields = common_fields_for(command, common);
  CompletionCommand described{command.word,           command.summary,     {},
                              command.inputs.max > 0, command.inputs.name, command.inputs.choices};
  for (const OptionList* list : {&command.options, &common_fields}) {
    for (const OptionField& field : list->fields) {
      if (!field.flag.empty()) described.flags.push_back(flag_of(command, field));
    }
  }
  for (const OptionEntry& entry : options_of_the_program()) {
    described.flags.push_back({entry.letter.empty() ? "" : entry.letter.substr(1),
                               entry.flag.substr(2),
                               entry.help,
                               "",
                               ValueKind::kNone,
                               {},
                               false});
  }
  return described;
}

}  // namespace

std::vector<CompletionCommand> completion_model(const std::vector<Command>& commands) {
  std::vector<CompletionCommand> model;
  CompletionCommand help{"help", "Explain a command", {}, true, "COMMAND", {}};
  for (const Command& command : commands) {
    model.push_back(describe(command));
    help.input_choices.push_back(command.word);
  }
  for (std::size_t i = 0; i < commands.size(); ++i) {
    if (commands[i].inputs.is_command) model[i].input_choices = help.input_choices;
  }
  model.push_back(std::move(help));
  return model;
}

}  // namespace pilotage
