#include "cli_options.h"

#include <algorithm>

#include "common_options.h"
#include <CLI/CLI.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

std::string cli11_name(const OptionField& field) {
  const std::string letter = short_flag(field.flag);
  const std::string name = (letter.empty() ? "" : "-" + letter + ",") + "--" + field.flag;
  return field.type == OptionType::kBool ? name + ",!--no-" + field.flag : name;
}

CLI::Option* add_field(CLI::App& app, const OptionField& field) {
  if (field.type == OptionType::kBool) return app.add_flag(cli11_name(field));
  // One value for each time the flag is given; how many a field takes is for set_from_text() to say.
  CLI::Option* option = app.add_option(cli11_name(field));
  option->expected(1, -1)->allow_extra_args(false)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  return option;
}

[[noreturn]] void throw_unknown_flag(const std::vector<const OptionList*>& lists, const std::string& argument) {
  const std::string typed = argument.substr(0, argument.find('='));
  std::vector<std::string> known = {"--help", "--version"};
  for (const OptionList* list : lists) {
    for (const OptionField& field : list->fields) {
      if (!field.flag.empty()) known.push_back("--" + field.flag);
    }
  }
  const std::string nearest = typed.starts_with("--") ? nearest_word(typed, known) : "";
  throw UsageError("unknown option " + typed +
                   (nearest.empty() ? "; --help lists them" : "; did you mean " + nearest + "?"));
}

// CLI11 takes "--flag=" for a flag without a value and eats the next argument.
void refuse_empty_assignments(const std::vector<std::string>& arguments) {
  for (const std::string& argument : arguments) {
    if (argument == "--") return;
    if (argument.starts_with("--") && argument.find('=') == argument.size() - 1) {
      throw UsageError(argument + " gives no value; an empty one is written " +
                       argument.substr(0, argument.size() - 1) + " ''");
    }
  }
}

}  // namespace

void take_flags_away(OptionList& options, const std::vector<std::string>& paths) {
  for (const std::string& path : paths) {
    for (OptionField& field : options.fields) {
      if (field.path == path || field.path.starts_with(path + ".")) field.flag.clear();
    }
  }
}

ParsedLine parse_line(const std::vector<const OptionList*>& lists, const std::vector<std::string>& arguments) {
  refuse_empty_assignments(arguments);
  ParsedLine line;
  CLI::App app;
  app.set_help_flag();
  app.allow_extras();
  app.add_flag("-h,--help", line.help);
  app.add_flag("--version", line.version);
  app.add_option("inputs", line.inputs)->expected(0, -1);
  std::vector<std::pair<const OptionField*, CLI::Option*>> options;
  for (const OptionList* list : lists) {
    for (const OptionField& field : list->fields) {
      if (!field.flag.empty()) options.emplace_back(&field, add_field(app, field));
    }
  }
  try {
    app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
  } catch (const CLI::ArgumentMismatch& error) {  // "--size-px: 1 required INTEGER missing"
    const std::string text = error.what();
    throw UsageError(text.substr(0, text.find(':')) + " needs a value");
  } catch (const CLI::ParseError& error) {
    throw UsageError(error.what());
  }
  std::vector<std::string> unknown = app.remaining();
  std::erase(unknown, "--");
  if (!unknown.empty()) throw_unknown_flag(lists, unknown.front());
  for (const auto& [field, option] : options) {
    if (option->count() == 0) continue;
    const bool is_bool = field->type == OptionType::kBool;
    line.flags.emplace_back(field->flag,
                            is_bool ? std::vector{option->results().back()} : std::vector(option->results()));
  }
  return line;
}

void apply_flags(const OptionList& list, const ParsedLine& line) {
  for (const OptionField& field : list.fields) {
    const auto given =
        std::find_if(line.flags.begin(), line.flags.end(), [&](const auto& flag) { return flag.first == field.flag; });
    if (given == line.flags.end()) continue;
    try {
      set_from_text(field, given->second);
    } catch (const UsageError& error) {
      const std::string message = error.what();
      throw UsageError("--" + field.flag +
                       (message.starts_with(field.path) ? message.substr(field.path.size()) : ": " + message));
    }
  }
}

}  // namespace pilotage
