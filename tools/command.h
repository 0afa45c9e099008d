#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "exit_code.h"
#include "input_guard.h"
#include <nlohmann/json.hpp>

#include "pilotage/base/options.h"
#include "pilotage/base/progress.h"

namespace pilotage {

/// Where a command stands in the way of the data; `pilotage --help` lists the groups in this order.
enum class CommandGroup { kPrepare, kStages, kInspect, kTune, kLandmarks, kHelp };

struct CommandExample {
  std::string what;  ///< One line: what it does.
  std::string line;  ///< What is typed, "pilotage score ortho.tif -o scores.tif".
};

/// The arguments without a flag.
struct InputSpec {
  static constexpr int kMany = std::numeric_limits<int>::max();

  std::string name = "INPUT";  ///< As usage shows it, in capitals; of inputs that differ each: "MAP [FRAME]".
  std::string help;
  int min = 0;
  int max = 0;                            ///< kMany: any number.
  bool is_config = false;                 ///< The one input is a configuration file: `pilotage prepare mission.json`.
  bool is_command = false;                ///< Words of commands: `pilotage manual score`.
  std::vector<std::string> choices = {};  ///< Words that are allowed; empty: files and other names.
  bool may_stream = false;                ///< "-" is standard input, which is_config takes, too.
  std::vector<std::string> stream_flags = {};  ///< Options for which "-" is standard input: "frames".
};

/// What `-o` means. With kFile, an output that exists is refused before any work is done unless --overwrite is given;
/// a command that makes a folder decides for the files in it.
enum class OutputKind { kNone, kFile, kFolder };

struct OutputSpec {
  OutputKind kind = OutputKind::kNone;
  std::string help;
  bool required = true;
  std::vector<std::string> flags = {};  ///< Of options that name further outputs: "table".
  /// Of options that name folders into which outputs go, beside what is read there: "evaluation". The command looks
  /// after the files itself.
  std::vector<std::string> folder_flags = {};
  /// All files that are written or replaced when this is given for -o; with kFile and without a function that file.
  std::function<std::vector<std::filesystem::path>(const std::string& output)> files = {};
  /// `-o -` prints the output, and this is the name that its kind is told by: "plan.json". "" where there is no such
  /// output: several files that belong together, or one that is not for pipes.
  std::string stream_name = {};
};

struct Command;

/// What a command is run with, besides its own options.
struct Invocation {
  std::vector<std::string> inputs;  ///< As typed; GDAL dataset strings are allowed where imagery is.
  /// These, and what options name, for refuse_shared_files. A command whose outputs depend on its options or on what it
  /// reads compares them itself; those of OutputSpec are compared before it runs.
  std::vector<NamedFile> named_inputs;
  std::string output;          ///< "" when none was given.
  bool prints_output = false;  ///< `-o -`: of what is written only the file `output` is kept, and printed.
  bool overwrite = false;
  int threads = 0;  ///< 0 = all cores.
  std::uint64_t seed = 1;
  Progress progress;                               ///< Never empty: also carries the user's wish to stop.
  std::function<bool()> go_on;                     ///< That wish alone, for any thread. Never empty.
  std::function<void(const std::string&)> say;     ///< A line on standard error at once, -q or not. Never empty.
  const std::vector<Command>* commands = nullptr;  ///< All of the program, never null.
};

/// What a command has to say; the caller prints it.
struct CommandResult {
  int exit_code = kExitDone;
  std::string text;                   ///< For people, on stdout, whole lines.
  nlohmann::ordered_json json;        ///< For programs, on stdout with --json: the same content. An object.
  std::vector<std::string> warnings;  ///< On stderr, and as "warnings" in the JSON.
};

/// A subcommand: one per library folder, each in its own command_<word>.cc as `Command make_<word>_command()`.
/// `options` is bound to an options object that `run` keeps alive (bind_options, below).
struct Command {
  std::string word;  ///< "score"; of a family "landmark-label", which may be typed as two words, too.
  CommandGroup group = CommandGroup::kStages;
  std::string summary;  ///< At most 64 characters, begins with a capital, no full stop.
  std::vector<CommandExample> examples;
  InputSpec inputs;
  OutputSpec output;
  bool reads_rasters = false;  ///< It takes the options that say what rasters may make GDAL reach.
  OptionList options;
  /// Called once, after `options` hold the configuration file and the command line. Throws as the library does.
  std::function<CommandResult(const Invocation&)> run;
};

/// Binds a command to the options struct of its library function: `run` is called with the options as the user set
/// them.
///
///   bind_options<ScoreOptions>(command, [](const ScoreOptions& options, const Invocation& invocation) { … });
template <class Options, class Run>
void bind_options(Command& command, Run run) {
  auto options = std::make_shared<Options>();
  command.options = list_options(*options);
  command.run = [options, run](const Invocation& invocation) -> CommandResult { return run(*options, invocation); };
}

}  // namespace pilotage
