#include "option_text.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "common_options.h"

#include "pilotage/base/text.h"

namespace pilotage {
namespace {

constexpr std::pair<const char*, const char*> kUnits[] = {
    {"_mps", "m/s"},   {"_mib", "MiB"},     {"_ms", "ms"},    {"_deg", "degrees"}, {"_rad", "radians"},
    {"_px", "pixels"}, {"_mm", "mm"},       {"_km", "km"},    {"_m", "m"},         {"_s", "s"},
    {"_hz", "Hz"},     {"_bytes", "bytes"}, {"_bits", "bits"}};

/// "100000" and "0.0001" where the shortest text would be "1e+05" and "1e-04".
std::string plain_number(double number) {
  std::string text = format_number(number);
  if (text.find('e') == std::string::npos || std::abs(number) < 1e-6) return text;
  text = format_fixed(number, 6);
  text.erase(text.find_last_not_of('0') + 1);
  return text.ends_with('.') ? text.substr(0, text.size() - 1) : text;
}

std::string range_text(const Range& range) {
  constexpr double kPractically = 1e15;  // beyond it a bound is there for the type's sake
  if (range.max >= kPractically) return "at least " + plain_number(range.min);
  return plain_number(range.min) + " to " + plain_number(range.max);
}

std::string value_name(const OptionField& field) {
  if (field.flag == "gdal-config") return "KEY=VALUE";
  switch (field.type) {
    case OptionType::kBool:
      return "";
    case OptionType::kInteger:
      return "INTEGER";
    case OptionType::kNumber:
      return "NUMBER";
    case OptionType::kNumberList:
      return "NUMBERS";
    case OptionType::kStringList:
      return field.is_path ? "PATH" : field.choices.empty() ? "LIST" : "NAMES";
    default:
      return field.is_path ? "PATH" : field.choices.empty() ? "TEXT" : "NAME";
  }
}

std::string lower_first(std::string text) {
  if (!text.empty() && text.front() >= 'A' && text.front() <= 'Z') text.front() = static_cast<char>(text.front() + 32);
  return text;
}

// A list that holds all choices by default is not printed a second time.
std::string default_of(const OptionField& field) {
  const auto* names = std::get_if<std::vector<std::string>>(&field.default_value);
  if (names != nullptr && names->size() > 1 && *names == field.choices) return "all";
  return option_to_text(field.default_value);
}

std::vector<std::string> limits_of(const OptionField& field) {
  std::vector<std::string> limits;
  if (const std::string unit = unit_of(field); !unit.empty()) limits.push_back(unit);
  if (field.range) limits.push_back(range_text(*field.range));
  if (!field.choices.empty()) limits.push_back(join(field.choices, " | "));
  if (field.is_path && field.type == OptionType::kStringList) limits.emplace_back("may be repeated");
  const std::string default_text = default_of(field);
  if (field.type != OptionType::kBool && !default_text.empty()) limits.push_back("default " + default_text);
  return limits;
}

// "--flag value" as one piece, so that a broken line keeps them together.
std::vector<std::string> pieces_of(const std::string& line) {
  std::vector<std::string> pieces;
  std::istringstream words(line);
  for (std::string word; words >> word;) {
    const bool after_flag =
        !pieces.empty() && pieces.back().starts_with("-") && pieces.back().find(' ') == std::string::npos;
    if (after_flag && !word.starts_with("-")) {
      pieces.back() += " " + word;
    } else {
      pieces.push_back(word);
    }
  }
  return pieces;
}

}  // namespace

std::string unit_of(const OptionField& field) {
  const bool numeric =
      field.type == OptionType::kInteger || field.type == OptionType::kNumber || field.type == OptionType::kNumberList;
  if (!numeric) return "";
  for (const auto& [suffix, unit] : kUnits) {
    if (field.path.ends_with(suffix)) return unit;
  }
  return "";
}

std::string group_of(const OptionField& field) {
  const auto dot = field.path.rfind('.');
  return dot == std::string::npos ? "" : field.path.substr(0, dot);
}

OptionEntry describe_option(const OptionField& field) {
  const bool on_by_default = field.type == OptionType::kBool && field.default_value == OptionValue(true);
  const std::string letter = short_flag(field.flag);
  return {letter.empty() ? "" : "-" + letter, (on_by_default ? "--no-" : "--") + field.flag, value_name(field),
          on_by_default ? "Do not " + lower_first(field.help) : field.help, limits_of(field)};
}

std::vector<OptionSection> describe_options(const OptionList& list) {
  std::vector<OptionSection> sections;
  const auto add_section = [&](const std::string& heading, const std::string& group) {
    OptionSection section{heading.ends_with('.') ? heading.substr(0, heading.size() - 1) : heading, {}};
    for (const OptionField& field : list.fields) {
      if (!field.flag.empty() && group_of(field) == group) section.entries.push_back(describe_option(field));
    }
    if (!section.entries.empty()) sections.push_back(std::move(section));
  };
  add_section("", "");
  for (const OptionGroup& group : list.groups) add_section(group.help, group.path);
  return sections;
}

std::vector<OptionEntry> options_of_the_program() {
  return {{"-h", "--help", "", "Print this and stop; `--help all` explains every option.", {}},
          {"", "--version", "", "Print the version and stop.", {}}};
}

std::string option_name(const OptionEntry& entry) {
  return (entry.letter.empty() ? "" : entry.letter + ", ") + entry.flag +
         (entry.value.empty() ? "" : " " + entry.value);
}

std::string program_summary() {
  return "Reference maps for aircraft that find their position by sight without GNSS";
}

std::vector<std::pair<std::string, std::string>> environment_variables() {
  return {{"NO_COLOR", "When it is set and not empty, nothing is coloured."},
          {"CLICOLOR_FORCE",
           "When it is set to anything but 0, colours are used although the output is no terminal; "
           "NO_COLOR is stronger."},
          {"TERM", "\"dumb\" stands for a terminal without colours and without a cursor that moves."},
          {"PILOTAGE_KEY_PASSPHRASE", "Passphrase of the key of `--sign-key`."}};
}

std::vector<std::pair<CommandGroup, std::string>> command_groups() {
  return {{CommandGroup::kPrepare, "Prepare a map"},
          {CommandGroup::kStages, "Stage by stage"},
          {CommandGroup::kInspect, "Look at files and flights"},
          {CommandGroup::kTune, "Compare and tune"},
          {CommandGroup::kLandmarks, "Landmarks"},
          {CommandGroup::kHelp, "Set up"}};
}

std::string usage_of(const Command& command) {
  std::string usage = "pilotage " + command.word + " [OPTIONS]";
  if (command.inputs.max > 0) {
    const bool each_named = command.inputs.name.find(' ') != std::string::npos;
    const std::string name = command.inputs.name + (command.inputs.max > 1 && !each_named ? "..." : "");
    usage += command.inputs.min > 0 ? " " + name : " [" + name + "]";
  }
  if (command.output.kind != OutputKind::kNone) usage += command.output.required ? " -o OUTPUT" : " [-o OUTPUT]";
  return usage;
}

std::size_t text_width(std::string_view text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

std::string wrap_text(const std::string& text, std::size_t indent, std::size_t width) {
  std::string wrapped;
  std::string line;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (!line.empty() && indent + text_width(line) + 1 + text_width(word) > width) {
      wrapped += std::string(indent, ' ') + line + "\n";
      line.clear();
    }
    line += (line.empty() ? "" : " ") + word;
  }
  return wrapped + std::string(indent, ' ') + line + "\n";
}

std::string wrap_command(const std::string& line, std::size_t indent, std::size_t width) {
  constexpr std::size_t kContinuation = 4;
  if (indent + text_width(line) <= width) return std::string(indent, ' ') + line + "\n";
  std::string wrapped;
  std::string current(indent, ' ');
  bool empty = true;
  for (const std::string& piece : pieces_of(line)) {
    if (!empty && text_width(current) + 1 + text_width(piece) + 2 > width) {
      wrapped += current + " \\\n";
      current = std::string(indent + kContinuation, ' ');
      empty = true;
    }
    current += (empty ? "" : " ") + piece;
    empty = false;
  }
  return wrapped + current + "\n";
}

}  // namespace pilotage
