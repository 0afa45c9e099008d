#include "help.h"

#include <algorithm>
#include <string_view>

#include "option_text.h"

#include "pilotage/base/text.h"

namespace pilotage {
namespace {

constexpr std::size_t kHelpColumn = 30;

std::string entry(const std::string& left, const std::string& right) {
  const std::string head = "  " + left;
  const std::string body = wrap_text(right, kHelpColumn);
  if (text_width(head) + 2 > kHelpColumn) return head + "\n" + body;
  return head + body.substr(text_width(head));
}

std::string entry(const OptionEntry& option) {
  const std::string limits = option.limits.empty() ? "" : " [" + join(option.limits, "; ") + "]";
  return entry(option_name(option), option.help + limits);
}

/// "--camera-* (14)": the flags of a group by what they have in common; the first of them where that is nothing.
std::string flags_of(const OptionSection& section) {
  std::string common = section.entries.front().flag;
  for (const OptionEntry& option : section.entries) {
    const auto differ = std::mismatch(common.begin(), common.end(), option.flag.begin(), option.flag.end());
    common.erase(differ.first, common.end());
  }
  common.erase(common.rfind('-') + 1);  // whole words
  const bool alike = common.size() > std::string_view("--").size();
  return (alike ? common + "*" : section.entries.front().flag + " …") + " (" + std::to_string(section.entries.size()) +
         ")";
}

std::string named_groups(const Command& command, const std::vector<OptionSection>& sections) {
  std::string text = "\nMore options, explained by `pilotage " + command.word + " --help all`:\n";
  for (const OptionSection& section : sections) {
    if (!section.heading.empty()) text += entry(flags_of(section), section.heading + ".");
  }
  return text;
}

/// "landmark label, train, score": the words of a family, what they share said once.
std::string short_words(const std::vector<std::string>& words) {
  std::vector<std::string> shown;
  std::string family;
  for (const std::string& word : words) {
    const auto dash = word.find('-');
    const std::string own = dash == std::string::npos ? "" : word.substr(0, dash);
    if (own.empty()) {
      shown.push_back(word);
    } else {
      shown.push_back((own == family ? "" : own + " ") + word.substr(dash + 1));
    }
    family = own;
  }
  return join(shown, ", ");
}

}  // namespace

std::string overview_help(const std::vector<Command>& commands) {
  // What the program is says its page: all commands must fit a screen.
  std::string text = "Usage: pilotage COMMAND [OPTIONS] INPUT... -o OUTPUT, COMMAND --help, --version\n";
  std::vector<std::string> others;  // words that say enough, or that few look for
  for (const auto& [group, heading] : command_groups()) {
    std::string lines;
    const bool is_listed = group < CommandGroup::kTune;
    for (const Command& command : commands) {
      if (command.group != group) continue;
      if (!is_listed) others.push_back(command.word);
      lines += "  " + command.word +
               std::string(std::max<std::size_t>(12, command.word.size() + 1) - command.word.size(), ' ') +
               command.summary + "\n";
    }
    if (is_listed && !lines.empty()) text += heading + ":\n" + lines;
  }
  return others.empty() ? text : text + "Others: " + short_words(others) + "\n";
}

std::string command_help(const Command& command, const OptionList& common, bool all) {
  std::string text = "Usage: " + usage_of(command) + "\n\n" + wrap_text(command.summary + ".", 0);
  for (const CommandExample& example : command.examples) {
    text += "\n" + wrap_text("# " + example.what, 2) + wrap_command(example.line, 2);
  }
  if (!command.inputs.help.empty()) text += "\nInputs:\n" + entry(command.inputs.name, command.inputs.help);
  const std::vector<OptionSection> sections = describe_options(command.options);
  const bool shortened = !all && command.options.fields.size() > kManyOptions;
  for (const OptionSection& section : sections) {
    if (shortened && !section.heading.empty()) continue;
    text += "\n" + wrap_text((section.heading.empty() ? "Options" : section.heading) + ":", 0);
    for (const OptionEntry& option : section.entries) text += entry(option);
  }
  if (shortened) text += named_groups(command, sections);
  text += "\nCommon options:\n";
  for (const OptionField& field : common.fields) text += entry(describe_option(field));
  for (const OptionEntry& option : options_of_the_program()) text += entry(option);
  return text;
}

}  // namespace pilotage
