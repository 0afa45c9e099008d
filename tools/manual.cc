#include "manual.h"

#include <string_view>

#include "common_options.h"
#include "exit_code.h"
#include "option_text.h"

#include "pilotage/base/text.h"

namespace pilotage {
namespace {

// man(7): a backslash begins an escape, "-" is a hyphen unless "\-", and "." or "'" at the start of a line a request.
std::string roff(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '\\') {
      result += "\\e";
    } else if (c == '-') {
      result += "\\-";
    } else {
      result += c;
    }
  }
  const bool request = !result.empty() && (result.front() == '.' || result.front() == '\'');
  return (request ? "\\&" : "") + result;
}

// One line of text; quotes would end an argument of a macro.
std::string macro_argument(std::string_view text) {
  std::string result = "\"";
  for (const char c : roff(text)) result += c == '"' ? std::string("\\(dq") : std::string(1, c);
  return result + "\"";
}

std::string heading(const std::string& name, const std::string& summary, const std::string& version) {
  std::string upper = name;
  for (char& c : upper) c = static_cast<char>(c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c);
  return ".TH " + macro_argument(upper) + " 1 \"\" " + macro_argument(version) +
         " \"Pilotage\"\n.nh\n.ad l\n.SH NAME\n" + roff(name) + " \\- " + roff(summary) + "\n";
}

std::string literal(const std::string& lines) {
  return ".PP\n.in +4n\n.nf\n" + lines + ".fi\n.in\n";
}

std::string lines_of(const std::string& wrapped) {
  std::string result;
  std::string line;
  for (const char c : wrapped) {
    if (c != '\n') {
      line += c;
      continue;
    }
    result += roff(line) + "\n";
    line.clear();
  }
  return result;
}

std::string option_item(const OptionEntry& option) {
  std::string text = ".TP\n.B " + macro_argument((option.letter.empty() ? "" : option.letter + ", ") + option.flag);
  if (!option.value.empty()) {
    text.replace(text.rfind(".B "), 3, ".BI ");
    text += " \" " + roff(option.value) + "\"";
  }
  text += "\n" + roff(option.help) + "\n";
  if (!option.limits.empty()) text += roff("[" + join(option.limits, "; ") + "]") + "\n";
  return text;
}

std::string examples_of(const Command& command) {
  if (command.examples.empty()) return "";
  constexpr std::size_t kWidth = 68;  // of 80, less the margins of man
  std::string text = ".SH EXAMPLES\n";
  for (const CommandExample& example : command.examples) {
    text += ".PP\n" + roff(example.what) + "\n" + literal(lines_of(wrap_command(example.line, 0, kWidth)));
  }
  return text;
}

std::string exit_status() {
  std::string text = ".SH EXIT STATUS\n";
  for (const auto& [code, meaning] : exit_codes()) {
    text += ".TP\n.B " + std::to_string(code) + "\n" + roff(meaning) + "\n";
  }
  return text;
}

std::string markdown_cell(const std::string& text) {
  std::string result;
  for (const char c : text) result += c == '|' ? std::string("\\|") : std::string(1, c);
  return result;
}

}  // namespace

ManualPage manual_of_program(const std::vector<Command>& commands, const std::string& version) {
  std::string text = heading("pilotage", program_summary(), version) + ".SH SYNOPSIS\n.B pilotage\n.I COMMAND\n" +
                     "[OPTIONS] INPUT... \\-o OUTPUT\n.SH COMMANDS\n";
  std::string pages;
  for (const auto& [group, title] : command_groups()) {
    std::string items;
    for (const Command& command : commands) {
      if (command.group != group) continue;
      items += ".TP\n.BR pilotage\\-" + command.word + " (1)\n" + roff(command.summary) + "\n";
      pages += (pages.empty() ? "" : " ,\n") + std::string(".BR pilotage\\-") + command.word + " (1)";
    }
    if (!items.empty()) text += ".SS " + macro_argument(title) + "\n" + items;
  }
  text += ".SH OPTIONS\n";
  for (const OptionEntry& option : options_of_the_program()) text += option_item(option);
  text += exit_status() + ".SH ENVIRONMENT\n";
  for (const auto& [name, meaning] : environment_variables()) text += ".TP\n.B " + name + "\n" + roff(meaning) + "\n";
  return {"pilotage.1", text + ".SH SEE ALSO\n" + pages + "\n"};
}

ManualPage manual_of_command(const Command& command, const std::string& version) {
  const std::string name = "pilotage-" + command.word;
  std::string text = heading(name, command.summary, version) + ".SH SYNOPSIS\n" + roff(usage_of(command)) + "\n";
  text += ".SH DESCRIPTION\n" + roff(command.summary + ".") + "\n";
  if (command.output.kind != OutputKind::kNone) {
    text += ".PP\n.B \\-o\n.IR OUTPUT :\n" + roff(command.output.help) + "\n";
  }
  text += examples_of(command);
  if (!command.inputs.help.empty()) {
    text += ".SH INPUTS\n.TP\n.I " + macro_argument(command.inputs.name) + "\n" + roff(command.inputs.help) + "\n";
  }
  const std::vector<OptionSection> sections = describe_options(command.options);
  if (!sections.empty()) text += ".SH OPTIONS\n";
  for (const OptionSection& section : sections) {
    if (!section.heading.empty()) text += ".SS " + macro_argument(section.heading) + "\n";
    for (const OptionEntry& option : section.entries) text += option_item(option);
  }
  text += ".SH COMMON OPTIONS\n";
  CommonOptions common;
  for (const OptionField& field : common_fields_for(command, common).fields)
    text += option_item(describe_option(field));
  for (const OptionEntry& option : options_of_the_program()) text += option_item(option);
  return {name + ".1", text + exit_status() + ".SH SEE ALSO\n.BR pilotage (1)\n"};
}

std::string option_tables(const Command& command) {
  std::string text;
  for (const OptionSection& section : describe_options(command.options)) {
    if (!section.heading.empty()) text += "\n**" + section.heading + "**\n\n";
    text += "| option | meaning | unit, range, default |\n|---|---|---|\n";
    for (const OptionEntry& option : section.entries) {
      text += "| `" + option_name(option) + "` | " + markdown_cell(option.help) + " | " +
              markdown_cell(join(option.limits, "; ")) + " |\n";
    }
  }
  return text;
}

}  // namespace pilotage
