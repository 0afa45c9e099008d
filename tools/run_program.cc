#include "run_program.h"

#include <algorithm>
#include <exception>
#include <filesystem>
#include <optional>
#include <ostream>
#include <regex>
#include <sstream>

#include "cli_options.h"
#include "common_options.h"
#include "help.h"
#include "input_guard.h"
#include "interruption.h"
#include "option_text.h"
#include "standard_streams.h"
#include "terminal.h"
#include "version.h"
#include <nlohmann/json.hpp>
#include <opencv2/core/base.hpp>
#include <opencv2/core/utility.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/options_json.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/base/utf8.h"
#include "pilotage/mapdb/map_signature.h"
#include "pilotage/raster/gdal_access.h"
#include "pilotage/raster/gdal_config.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

int print(std::ostream& out, const std::string& text) {
  out << text;
  return kExitDone;
}

/// `code`: of ECMA-48's "select graphic rendition", 31 for red, 1;36 for bold cyan.
std::string in_colour(const std::ostream& stream, const char* code, const std::string& text) {
  return wants_colour(stream) ? "\x1b[" + std::string(code) + "m" + text + "\x1b[0m" : text;
}

/// Text that comes from files is shown, not obeyed: control characters (but line ends and tabs) as \xHH, so that no map
/// or route moves the cursor of a terminal or changes its colours; bytes that are no UTF-8 likewise.
std::string shown(std::string_view text) {
  static constexpr char kHex[] = "0123456789abcdef";
  std::string safe;
  while (!text.empty()) {
    const std::size_t length = utf8_sequence_length(text);
    const auto first = static_cast<unsigned char>(text.front());
    const auto last = static_cast<unsigned char>(text[std::max<std::size_t>(length, 1) - 1]);
    const bool c0 = length == 1 && (first < 0x20 || first == 0x7F) && first != '\n' && first != '\t';
    const bool c1 = length == 2 && first == 0xC2 && last < 0xA0;  // U+0080 … U+009F, which some terminals obey, too
    if (length > 0 && !c0 && !c1) {
      safe += text.substr(0, length);
    } else {
      safe += {'\\', 'x', kHex[last >> 4], kHex[last & 15]};
    }
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return safe;
}

/// A message about an unfinished output, whose place is a hidden folder (base/work_folder.h), names where it would
/// stand.
std::string of_outputs(const std::string& message) {
  static const std::regex work_folder("\\.pilotage-[0-9a-f]{8}-[A-Za-z0-9]{6}/");
  return std::regex_replace(message, work_folder, "");
}

/// On a terminal the headings stand out: the lines at the margin that end with a colon.
int print_help(std::ostream& out, const std::string& text) {
  if (!wants_colour(out)) return print(out, text);
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const bool heading = !line.empty() && line.front() != ' ' && line.back() == ':';
    out << (heading ? in_colour(out, "1", line) : line) << "\n";
  }
  return kExitDone;
}

/// The verdict that a text begins with, in the terminal's nearest colours to those of the page and of maps.
std::string with_verdict(const std::ostream& stream, const std::string& text) {
  static constexpr std::pair<std::string_view, const char*> kColours[] = {
      {"GO:", "1;36"}, {"MARGINAL:", "1;33"}, {"NO-GO:", "1;35"}};
  for (const auto& [word, code] : kColours) {
    if (!text.starts_with(word)) continue;
    return in_colour(stream, code, std::string(word)) + text.substr(word.size());
  }
  return text;
}

/// JSON escapes U+0000 … U+001F itself; the other control characters stand only in its strings, too.
std::string dump(const Json& json) {
  static constexpr char kHex[] = "0123456789abcdef";
  const std::string text = json_text(json, 2);
  std::string safe;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool c1 = text[i] == '\xC2' && static_cast<unsigned char>(text[i + 1]) < 0xA0;
    if (!c1 && text[i] != '\x7F') {
      safe += text[i];
      continue;
    }
    const auto control = static_cast<unsigned char>(c1 ? text[++i] : text[i]);
    safe += std::string("\\u00") + kHex[control >> 4] + kHex[control & 15];
  }
  return safe;
}

Command& find_command(std::vector<Command>& commands, const std::string& word) {
  const auto found = std::find_if(commands.begin(), commands.end(), [&](const auto& c) { return c.word == word; });
  if (found != commands.end()) return *found;
  std::vector<std::string> words;
  for (const Command& command : commands) words.push_back(command.word);
  words.insert(words.end(), {"help", "--help", "--version"});
  const std::string nearest = nearest_word(word, words);
  throw UsageError((word.starts_with("-") ? "unknown option " + word : "unknown command \"" + word + "\"") +
                   (nearest.empty() ? "; pilotage --help lists them" : "; did you mean \"" + nearest + "\"?"));
}

void check_inputs(const Command& command, const std::vector<std::string>& inputs) {
  const auto count = static_cast<int>(std::min<std::size_t>(inputs.size(), InputSpec::kMany));
  if (count < command.inputs.min) {
    throw UsageError(count == 0 ? command.inputs.name + " is missing: " + command.inputs.help
                                : "at least " + std::to_string(command.inputs.min) + " of " + command.inputs.name +
                                      " are needed, " + std::to_string(count) + " given");
  }
  for (const std::string& input : inputs) {
    if (input.empty()) throw UsageError(command.inputs.name + " is empty: " + command.inputs.help);
  }
  const std::vector<std::string>& choices = command.inputs.choices;
  for (const std::string& input : inputs) {
    if (choices.empty() || std::find(choices.begin(), choices.end(), input) != choices.end()) continue;
    throw UsageError(command.inputs.name + " = \"" + input + "\" is not one of: " + join(choices, ", "));
  }
  if (count > command.inputs.max) {
    const std::string& first_extra = inputs[static_cast<std::size_t>(command.inputs.max)];
    throw UsageError("unexpected argument \"" + first_extra + "\"; usage: " + usage_of(command));
  }
}

/// What options that hold paths name: the outputs among them, or all others.
std::vector<NamedFile> files_of_options(const Command& command, bool outputs) {
  std::vector<NamedFile> files;
  for (const OptionField& field : command.options.fields) {
    const auto is_of = [&](const std::vector<std::string>& flags) {
      return std::find(flags.begin(), flags.end(), field.flag) != flags.end();
    };
    if (!field.is_path || is_of(command.output.flags) != outputs || is_of(command.output.folder_flags)) continue;
    for (const std::string& path : paths_of(field)) {
      if (!path.empty()) files.push_back({"--" + field.flag, path});
    }
  }
  return files;
}

std::vector<NamedFile> named_inputs(const Command& command, const CommonOptions& common,
                                    const std::vector<std::string>& arguments) {
  std::vector<NamedFile> inputs = files_of_options(command, false);
  for (const std::string& argument : arguments) inputs.push_back({command.inputs.name, argument});
  if (!common.config.empty()) inputs.push_back({"--config", common.config});
  // What stands beside a signed input is read with it.
  for (std::size_t i = 0, named = inputs.size(); i < named; ++i) {
    const NamedFile input = inputs[i];
    inputs.push_back({input.flag, signature_path_of(input.path)});
    inputs.push_back({input.flag, chunk_list_path_of(input.path)});
  }
  return inputs;
}

/// Everything that the command line and the configuration name, before the command opens anything.
void check_shared_files(const Command& command, const CommonOptions& common, const std::vector<NamedFile>& inputs) {
  std::vector<NamedFile> outputs = files_of_options(command, true);
  if (!common.output.empty() && command.output.files) {
    for (const auto& path : command.output.files(common.output)) outputs.push_back({"--output", path});
  } else if (!common.output.empty() && command.output.kind == OutputKind::kFile) {
    outputs.push_back({"--output", common.output});
  }
  refuse_shared_files(inputs, outputs);
}

void check_output(const Command& command, const CommonOptions& common) {
  if (command.output.kind == OutputKind::kNone) return;
  if (common.output.empty()) {
    if (command.output.required) throw UsageError("-o OUTPUT is missing: " + command.output.help);
    return;
  }
  std::error_code ignored;
  if (command.output.kind == OutputKind::kFile && !std::filesystem::is_directory(common.output, ignored)) {
    refuse_special_file(common.output);
  }
  if (!std::filesystem::exists(common.output, ignored)) return;
  const bool is_folder = std::filesystem::is_directory(common.output, ignored);
  if (command.output.kind == OutputKind::kFolder && !is_folder) throw DataError(common.output + ": is not a folder");
  if (command.output.kind == OutputKind::kFile && is_folder) throw DataError(common.output + ": is a folder");
  if (command.output.kind == OutputKind::kFile && !common.overwrite) {
    throw DataError(common.output + ": exists already; give --overwrite to replace it");
  }
}

/// Defaults, then the configuration file, then the command line.
void fill_options(const Command& command, const CommonOptions& common, const ParsedLine& line) {
  std::string config = common.config;
  if (command.inputs.is_config && !line.inputs.empty()) {
    if (!config.empty()) throw UsageError("--config and " + command.inputs.name + " name the same thing; give one");
    config = line.inputs.front();
  }
  if (!config.empty()) load_named_config(command.options, config);
  apply_flags(command.options, line);
}

/// A command may describe "threads" or "seed" itself; the invocation carries the same numbers either way.
std::int64_t own_integer(const Command& command, const char* flag, std::int64_t otherwise) {
  for (const OptionField& field : command.options.fields) {
    if (field.flag != flag) continue;
    const OptionValue value = field.get();
    if (const auto* number = std::get_if<std::int64_t>(&value)) return *number;
  }
  return otherwise;
}

Invocation make_invocation(const std::vector<Command>& commands, const Command& command, const CommonOptions& common,
                           const ParsedLine& line, ProgressMeter& meter) {
  Invocation invocation;
  invocation.commands = &commands;
  invocation.inputs = line.inputs;
  invocation.output = common.output;
  invocation.overwrite = common.overwrite;
  invocation.threads = static_cast<int>(own_integer(command, "threads", common.threads));
  invocation.seed = static_cast<std::uint64_t>(own_integer(command, "seed", static_cast<std::int64_t>(common.seed)));
  invocation.progress = [&meter](std::string_view what, std::int64_t done, std::int64_t total) {
    meter.report(what, done, total);
    return !interruption_requested();
  };
  invocation.go_on = [] { return !interruption_requested(); };
  invocation.say = [&meter, word = command.word](const std::string& words) {
    meter.say("pilotage " + word + ": ", shown(words));
  };
  return invocation;
}

/// Where standard output carries the output of a command (`spool`), all words go to standard error.
void print_result(const Command& command, const CommonOptions& common, const CommandResult& result,
                  const std::optional<OutputSpool>& spool, std::ostream& out, std::ostream& err) {
  if (!common.quiet) {
    for (const std::string& warning : result.warnings) {
      err << "pilotage " << command.word << ": " << in_colour(err, "33", "warning:") << " " << shown(warning) << "\n";
    }
  }
  if (spool) {
    if (!common.quiet) err << shown(result.text);
    out << read_file(spool->file());
  } else if (common.json) {
    Json json = result.json.is_null() ? Json::object() : result.json;
    if (!json.contains("warnings")) json["warnings"] = result.warnings;
    out << dump(json);
  } else {
    // What the program says of itself is for shells and for man, byte by byte.
    out << (command.group == CommandGroup::kHelp ? result.text : with_verdict(out, shown(result.text)));
  }
}

int run_command(const std::vector<Command>& commands, const Command& command, const std::vector<std::string>& arguments,
                std::ostream& out, std::ostream& err, InterruptionDeadline& deadline) {
  CommonOptions common;
  const OptionList common_fields = common_fields_for(command, common);
  const ParsedLine line = parse_line({&command.options, &common_fields}, arguments);
  if (line.help)
    return print_help(out, command_help(command, common_fields, line.inputs == std::vector<std::string>{"all"}));
  if (line.version) return print(out, version_text());
  apply_flags(common_fields, line);
  if (common.print_schema) {
    return print(out, dump(options_schema(command.options, "pilotage " + command.word)));
  }
  if (!common.print_config || !line.inputs.empty()) check_inputs(command, line.inputs);
  fill_options(command, common, line);
  check_streams(command, common, line.inputs);
  if (common.print_config) return print(out, dump(options_to_json(command.options)));

  for (const std::string& key_value : common.gdal_config) set_gdal_config(key_value);
  if (common.allow_network || common.allow_any_vrt || !common.gdal_driver.empty()) {
    set_raster_access({common.allow_network, common.allow_any_vrt, common.gdal_driver});
  }
  watch_for_interruption();
  std::optional<OutputSpool> spool;
  if (common.output == kStandardStream) common.output = spool.emplace(command.output.stream_name).file();
  const std::vector<NamedFile> inputs = named_inputs(command, common, line.inputs);
  check_shared_files(command, common, inputs);
  check_output(command, common);
  ProgressMeter meter = make_progress_meter(common.quiet ? ProgressMode::kNone : common.progress, err);
  Invocation invocation = make_invocation(commands, command, common, line, meter);
  invocation.named_inputs = inputs;
  invocation.prints_output = spool.has_value();
  cv::setNumThreads(1);  // work is shared out by parallel_for; OpenCV's own threads would come on top of it
  CommandResult result;
  try {
    // Until it counts something. What runs whenever a shell starts leaves the terminal alone.
    if (command.group != CommandGroup::kHelp) report_progress(invocation.progress, "running " + command.word, 0, 0);
    result = command.run(invocation);
  } catch (...) {
    meter.clear();
    throw;
  }
  deadline.fall_silent();
  meter.clear();
  print_result(command, common, result, spool, out, err);
  return result.exit_code;
}

int dispatch(std::vector<Command>& commands, const std::vector<std::string>& arguments, std::ostream& out,
             std::ostream& err, InterruptionDeadline& deadline) {
  if (arguments.empty()) {
    err << overview_help(commands);
    return kExitUsage;
  }
  const std::string& word = arguments.front();
  const std::vector<std::string> rest(arguments.begin() + 1, arguments.end());
  if (word == "--version") return print(out, version_text());
  if (word == "--help" || word == "-h" || (word == "help" && rest.empty())) {
    return print_help(out, overview_help(commands));
  }
  if (word == "help") {
    std::vector<std::string> asked(rest.begin(), rest.end());
    asked.front() = "--help";
    return run_command(commands, find_command(commands, rest.front()), asked, out, err, deadline);
  }
  return run_command(commands, find_command(commands, word), rest, out, err, deadline);
}

/// "landmark label" is the command "landmark-label". Throws UsageError for a family without one of its words.
std::vector<std::string> with_family_joined(const std::vector<Command>& commands, std::vector<std::string> arguments) {
  const std::size_t at = !arguments.empty() && arguments.front() == "help" ? 1 : 0;
  if (arguments.size() <= at) return arguments;
  const std::string family = arguments[at] + "-";
  std::vector<std::string> members;
  for (const Command& command : commands) {
    if (command.word.starts_with(family)) members.push_back(command.word.substr(family.size()));
  }
  if (members.empty()) return arguments;
  const bool known =
      arguments.size() > at + 1 && std::find(members.begin(), members.end(), arguments[at + 1]) != members.end();
  const bool asks = at == 1 || (arguments.size() == 2 && (arguments[1] == "--help" || arguments[1] == "-h"));
  if (!known && asks) return {"--help"};  // the overview has them
  if (!known) throw UsageError("\"" + arguments[at] + "\" is followed by one of: " + join(members, ", "));
  const auto second = arguments.begin() + static_cast<std::ptrdiff_t>(at) + 1;
  arguments[at] = family + *second;
  arguments.erase(second);
  return arguments;
}

/// How an error is told: its exit code, and its kind for programs.
struct Failure {
  int exit_code;
  const char* kind;
  std::string message;
};

const Failure kInterruption{kExitInterrupted, "interrupted", "interrupted"};

Failure describe_current_exception() {
  try {
    throw;
  } catch (const Interrupted&) {
    return kInterruption;
  } catch (const UsageError& error) {
    return {kExitUsage, "usage", error.what()};
  } catch (const IntegrityError& error) {
    return {kExitIntegrity, "integrity", error.what()};
  } catch (const DataError& error) {
    return {kExitFailed, "data", error.what()};
  } catch (const std::filesystem::filesystem_error& error) {
    return {kExitFailed, "data", error.path1().string() + ": " + error.code().message()};
  } catch (const std::bad_alloc&) {
    return {kExitFailed, "memory", "not enough memory"};
  } catch (const cv::Exception& error) {
    if (error.code == cv::Error::StsNoMem) return {kExitFailed, "memory", "not enough memory"};
    return {kExitFailed, "internal", std::string("unexpected error: ") + error.what()};
  } catch (const std::exception& error) {
    return {kExitFailed, "internal", std::string("unexpected error: ") + error.what()};
  } catch (...) {
    return {kExitFailed, "internal", "unexpected error"};
  }
}

bool wants_json(const std::vector<std::string>& arguments) {
  for (const std::string& argument : arguments) {
    if (argument == "--") return false;
    if (argument == "--json" || argument == "--json=true") return true;
  }
  return false;
}

void print_failure(const Failure& failure, const std::vector<std::string>& arguments, std::ostream& out,
                   std::ostream& err) {
  const bool has_word = !arguments.empty() && !arguments.front().starts_with("-");
  const std::string who =
      "pilotage" + (has_word && failure.message.find("unknown command") != 0 ? " " + arguments.front() : std::string());
  const std::string message = of_outputs(failure.message);
  err << in_colour(err, "31", shown(who) + ":") << " " << shown(message) << std::endl;
  if (wants_json(arguments)) {
    out << dump({{"error", {{"kind", failure.kind}, {"message", message}, {"exit_code", failure.exit_code}}}});
  }
}

}  // namespace

int run_program(std::vector<Command> commands, const std::vector<std::string>& typed, std::ostream& out,
                std::ostream& err) {
  std::vector<std::string> arguments = typed;
  InterruptionDeadline deadline([&] {
    if (is_terminal(err)) err << "\n";  // below the bar that may stand there
    print_failure(kInterruption, arguments, out, err);
    out.flush();
  });
  try {
    arguments = with_family_joined(commands, arguments);
    const int exit_code = dispatch(commands, arguments, out, err, deadline);
    if (!out.flush()) throw DataError("standard output cannot be written");
    return exit_code;
  } catch (...) {
    deadline.fall_silent();
    const Failure failure = describe_current_exception();
    print_failure(failure, arguments, out, err);
    return failure.exit_code;
  }
}

}  // namespace pilotage
