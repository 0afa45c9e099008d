#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "command.h"

namespace pilotage {

/// How options and commands are put into words, once for the help screen, the manual pages, the completion and the
/// tables of docs/commands.

/// One option as people read it.
struct OptionEntry {
  std::string letter;               ///< "-o", or "".
  std::string flag;                 ///< "--output"; of a boolean that is on by default "--no-check".
  std::string value;                ///< "INTEGER"; "" of a boolean.
  std::string help;                 ///< "Side of a square tile."
  std::vector<std::string> limits;  ///< {"pixels", "2 to 4096", "default 256"}
};

/// The options of one group, under its heading ("" for those that stand alone).
struct OptionSection {
  std::string heading;
  std::vector<OptionEntry> entries;
};

OptionEntry describe_option(const OptionField& field);

/// "m/s" of a number whose name says so; "" of others.
std::string unit_of(const OptionField& field);

/// The group that a field stands in: "camera" of "camera.hfov_deg", "" of "stride_px".
std::string group_of(const OptionField& field);

/// Sections in the order of description; those without options of their own are left out.
std::vector<OptionSection> describe_options(const OptionList& list);

/// "-h, --help" and "--version", which are in no list.
std::vector<OptionEntry> options_of_the_program();

/// "-o, --output PATH"
std::string option_name(const OptionEntry& entry);

/// What the program is, in a line without a full stop.
std::string program_summary();

/// The environment variables that the program looks at, and what for.
std::vector<std::pair<std::string, std::string>> environment_variables();

/// The groups of commands by the way of the data, with their headings.
std::vector<std::pair<CommandGroup, std::string>> command_groups();

/// "pilotage score [OPTIONS] RASTER... -o OUTPUT"
std::string usage_of(const Command& command);

/// Characters, not bytes: continuation bytes of UTF-8 do not count.
std::size_t text_width(std::string_view text);

/// Breaks `text` at blanks into lines of at most `width` characters (UTF-8), each after `indent` blanks.
std::string wrap_text(const std::string& text, std::size_t indent, std::size_t width = 80);

/// Breaks a command line so that it can still be pasted: lines of at most `width` characters, all but the last ending
/// in " \". A flag stays beside its value.
std::string wrap_command(const std::string& line, std::size_t indent, std::size_t width = 80);

}  // namespace pilotage
