#include "help.h"

#include <algorithm>
#include <sstream>
#include <utility>

#include "common_options.h"

#include "pilotage/base/text.h"

namespace pilotage {
namespace {

constexpr std::size_t kHelpColumn = 30;

constexpr std::pair<CommandGroup, const char*> kGroups[] = {{CommandGroup::kPrepare, "Prepare a map"},
                                                            {CommandGroup::kStages, "Stage by stage"},
                                                            {CommandGroup::kInspect, "Look at files"},
                                                            {CommandGroup::kFlight, "In flight"},
                                                            {CommandGroup::kStudy, "Study"}};

constexpr std::pair<const char*, const char*> kUnits[] = {
    {"_mps", "m/s"}, {"_deg", "degrees"}, {"_rad", "radians"}, {"_px", "pixels"},   {"_mm", "mm"},    {"_km", "km"},
    {"_m", "m"},     {"_s", "s"},         {"_hz", "Hz"},       {"_bytes", "bytes"}, {"_bits", "bits"}};

/// Characters, not bytes: continuation bytes of UTF-8 do not count.
std::size_t text_width(std::string_view text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

std::string unit_of(const std::string& path) {
  for (const auto& [suffix, unit] : kUnits) {
    if (path.ends_with(suffix)) return unit;
  }
  return "";
}

std::string range_text(const Range& range) {
  constexpr double kPractically = 1e15;  // beyond it a bound is there for the type's sake
  if (range.max >= kPractically) return "at least " + format_number(range.min);
  return format_number(range.min) + " to " + format_number(range.max);
}

std::string value_name(const OptionField& field) {
  if (field.flag == "gdal-config") return " KEY=VALUE";
  switch (field.type) {
    case OptionType::kBool:
      return "";
    case OptionType::kInteger:
      return " INTEGER";
    case OptionType::kNumber:
      return " NUMBER";
    case OptionType::kNumberList:
      return " NUMBERS";
    case OptionType::kStringList:
      return field.is_path ? " PATH" : " LIST";
    default:
      return field.is_path ? " PATH" : field.choices.empty() ? " TEXT" : " NAME";
  }
}

/// "pixels; 16 to 4096; default 256"
std::string limits_text(const OptionField& field) {
  std::vector<std::string> parts;
  const bool numeric =
      field.type == OptionType::kInteger || field.type == OptionType::kNumber || field.type == OptionType::kNumberList;
  if (const std::string unit = unit_of(field.path); numeric && !unit.empty()) parts.push_back(unit);
  if (field.range) parts.push_back(range_text(*field.range));
  if (!field.choices.empty()) parts.push_back(join(field.choices, " | "));
  if (field.is_path && field.type == OptionType::kStringList) parts.emplace_back("may be repeated");
  const std::string default_text = option_to_text(field.default_value);
  if (field.type != OptionType::kBool && !default_text.empty()) parts.push_back("default " + default_text);
  return parts.empty() ? "" : " [" + join(parts, "; ") + "]";
}

std::string entry(const std::string& left, const std::string& right) {
  const std::string head = "  " + left;
  const std::string body = wrap_text(right, kHelpColumn);
  if (text_width(head) + 2 > kHelpColumn) return head + "\n" + body;
  return head + body.substr(text_width(head));
}

std::string field_entry(const OptionField& field) {
  const bool on_by_default = field.type == OptionType::kBool && field.default_value == OptionValue(true);
  const std::string letter = short_flag(field.flag);
  const std::string name = (letter.empty() ? "" : "-" + letter + ", ") + (on_by_default ? "--no-" : "--") + field.flag;
  return entry(name + value_name(field), (on_by_default ? "Do not: " : "") + field.help + limits_text(field));
}

std::string parent_of(const std::string& path) {
  const auto dot = path.rfind('.');
  return dot == std::string::npos ? "" : path.substr(0, dot);
}

/// The fields of a list under the headings of their groups.
std::string option_sections(const OptionList& list) {
  std::string text;
  const auto add_section = [&](const std::string& heading, const std::string& group) {
    std::string entries;
    for (const OptionField& field : list.fields) {
      if (parent_of(field.path) == group) entries += field_entry(field);
    }
    if (!entries.empty()) text += "\n" + wrap_text(heading, 0) + entries;
  };
  add_section("Options:", "");
  for (const OptionGroup& group : list.groups) add_section(group.help, group.path);
  return text;
}

std::string usage_line(const Command& command) {
  std::string usage = "Usage: pilotage " + command.word + " [OPTIONS]";
  if (command.inputs.max > 0) {
    const bool each_named = command.inputs.name.find(' ') != std::string::npos;
    const std::string name = command.inputs.name + (command.inputs.max > 1 && !each_named ? "..." : "");
    usage += command.inputs.min > 0 ? " " + name : " [" + name + "]";
  }
  if (command.output.kind != OutputKind::kNone) usage += command.output.required ? " -o OUTPUT" : " [-o OUTPUT]";
  return usage + "\n";
}

}  // namespace

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

std::string overview_help(const std::vector<Command>& commands) {
  std::string text =
      "Usage: pilotage COMMAND [OPTIONS] INPUT... -o OUTPUT\n"
      "Reference maps for aircraft that find their position by sight without GNSS.\n";
  for (const auto& [group, heading] : kGroups) {
    std::string lines;
    for (const Command& command : commands) {
      if (command.group != group) continue;
      lines += "  " + command.word +
               std::string(std::max<std::size_t>(12, command.word.size() + 1) - command.word.size(), ' ') +
               command.summary + "\n";
    }
    if (!lines.empty()) text += std::string(heading) + ":\n" + lines;
  }
  return text + "`pilotage COMMAND --help` explains a command; `--version` names the versions.\n";
}

std::string command_help(const Command& command, const OptionList& common) {
  std::string text = usage_line(command) + "\n" + wrap_text(command.summary + ".", 0);
  for (const CommandExample& example : command.examples) text += "\n  # " + example.what + "\n  " + example.line + "\n";
  if (!command.inputs.help.empty()) text += "\nInputs:\n" + entry(command.inputs.name, command.inputs.help);
  text += option_sections(command.options) + "\nCommon options:\n";
  for (const OptionField& field : common.fields) text += field_entry(field);
  return text + entry("-h, --help", "Print this and stop.") + entry("--version", "Print the version and stop.");
}

}  // namespace pilotage
