#include <algorithm>
#include <filesystem>

#include "commands.h"
#include "describe_commands.h"
#include "manual.h"
#include "version.h"

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

enum class ManualFormat { kMan, kMarkdown, kJson };
EnumNames<ManualFormat> enum_names(ManualFormat) {
  return {{ManualFormat::kMan, "man"}, {ManualFormat::kMarkdown, "markdown"}, {ManualFormat::kJson, "json"}};
}

struct ManualOptions {
  ManualFormat format = ManualFormat::kMan;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field(
        "format", self.format,
        "A page for man; only the tables of a command's options as docs/commands has them; or all commands and "
        "what they take, for programs.");
  }
};

const Command& find(const std::vector<Command>& commands, const std::string& word) {
  const auto found = std::find_if(commands.begin(), commands.end(), [&](const auto& c) { return c.word == word; });
  if (found != commands.end()) return *found;
  std::vector<std::string> words;
  for (const Command& command : commands) words.push_back(command.word);
  throw UsageError("\"" + word + "\" is not one of: " + join(words, ", "));
}

std::vector<ManualPage> all_pages(const std::vector<Command>& commands) {
  std::vector<ManualPage> pages{manual_of_program(commands, version_line())};
  for (const Command& command : commands) pages.push_back(manual_of_command(command, version_line()));
  return pages;
}

CommandResult write_pages(const Invocation& invocation) {
  const std::filesystem::path folder = invocation.output;
  std::filesystem::create_directories(folder);
  CommandResult result;
  result.json = {{"output", invocation.output}, {"files", nlohmann::ordered_json::array()}};
  for (const ManualPage& page : all_pages(*invocation.commands)) {
    write_file(folder / page.file, page.text, invocation.overwrite);
    result.json["files"].push_back(page.file);
  }
  result.text = std::to_string(result.json["files"].size()) + " pages in " + invocation.output + "\n";
  return result;
}

std::string page_text(ManualFormat format, const std::string& word, const std::vector<Command>& commands) {
  switch (format) {
    case ManualFormat::kJson:
      if (!word.empty()) throw UsageError("COMMAND does not go with --format json, which has all of them");
      return json_text(describe_commands(commands), 2);
    case ManualFormat::kMarkdown:
      if (word.empty()) throw UsageError("COMMAND is missing: only a command has options");
      return option_tables(find(commands, word));
    case ManualFormat::kMan:
      break;
  }
  return word.empty() ? manual_of_program(commands, version_line()).text
                      : manual_of_command(find(commands, word), version_line()).text;
}

CommandResult print_page(const ManualOptions& options, const Invocation& invocation) {
  const std::string word = invocation.inputs.empty() ? "" : invocation.inputs.front();
  CommandResult result;
  result.text = page_text(options.format, word, *invocation.commands);
  result.json = {{"format", options_detail::enum_to_name(options.format)}, {"page", result.text}};
  return result;
}

}  // namespace

Command make_manual_command() {
  Command command;
  command.word = "manual";
  command.group = CommandGroup::kHelp;
  command.summary = "Print a page of the manual, or write all of them";
  command.examples = {{"Read about a command.", "pilotage manual score | man -l -"},
                      {"Where man finds them.", "pilotage manual -o ~/.local/share/man/man1"}};
  command.inputs = {
      .name = "COMMAND", .help = "What the page is about; without it the program.", .max = 1, .is_command = true};
  command.output = {.kind = OutputKind::kFolder, .help = "Write all pages into this folder.", .required = false};
  bind_options<ManualOptions>(command, [](const ManualOptions& options, const Invocation& invocation) {
    if (invocation.output.empty()) return print_page(options, invocation);
    if (!invocation.inputs.empty() || options.format != ManualFormat::kMan) {
      throw UsageError("--output writes all pages: give neither COMMAND nor --format");
    }
    return write_pages(invocation);
  });
  return command;
}

}  // namespace pilotage
