#include "standard_streams.h"

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <system_error>

#include "input_guard.h"

#include "pilotage/base/config_file.h"
#include "pilotage/base/error.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

constexpr std::uintmax_t kMaxTableBytes = std::uintmax_t{1} << 30;

bool is_stream(const std::string& path) {
  return path == kStandardStream;
}

bool takes_stream(const Command& command, const std::string& flag) {
  const std::vector<std::string>& flags = command.inputs.stream_flags;
  return std::find(flags.begin(), flags.end(), flag) != flags.end();
}

/// Where "-" would be allowed.
std::string allowed_streams(const Command& command) {
  std::vector<std::string> reads;
  if (command.inputs.may_stream || command.inputs.is_config) reads.push_back(command.inputs.name);
  for (const std::string& flag : command.inputs.stream_flags) reads.push_back("--" + flag);
  reads.emplace_back("--config");
  return "here \"-\" is standard input for " + join(reads, ", ") +
         (command.output.stream_name.empty() ? "" : ", and standard output for -o") + "; a file of that name is ./-";
}

void refuse_stream(const Command& command, const std::string& what) {
  throw UsageError(what + " = \"-\" is no file; " + allowed_streams(command));
}

/// Options that are "-", of those that hold paths.
std::vector<std::string> streamed_flags(const Command& command) {
  std::vector<std::string> flags;
  for (const OptionField& field : command.options.fields) {
    if (!field.is_path) continue;
    const std::vector<std::string> paths = paths_of(field);
    if (std::any_of(paths.begin(), paths.end(), is_stream)) flags.push_back(field.flag);
  }
  return flags;
}

std::filesystem::path temporary_folder() {
  std::error_code error;
  std::filesystem::path folder = std::filesystem::temp_directory_path(error);
  if (error) throw DataError("-o - needs a folder for temporary files (TMPDIR): " + error.message());
  return folder;
}

}  // namespace

std::string read_standard_input(std::uintmax_t max_bytes) {
  std::string text;
  std::string part(std::size_t{1} << 16, '\0');
  while (std::cin) {
    std::cin.read(part.data(), static_cast<std::streamsize>(part.size()));
    text.append(part, 0, static_cast<std::size_t>(std::cin.gcount()));
    if (text.size() > max_bytes) {
      throw DataError("standard input: has more than the " + std::to_string(max_bytes) + " bytes that are allowed");
    }
  }
  if (std::cin.bad()) throw DataError("standard input: cannot be read");
  return text;
}

std::string read_named_input(const std::string& path) {
  return is_stream(path) ? read_standard_input(kMaxTableBytes) : read_file(path);
}

void load_named_config(const OptionList& list, const std::string& path) {
  if (!is_stream(path)) return load_config_file(list, path);
  load_config(list, "standard input", read_standard_input(kMaxConfigBytes), "");
}

void check_streams(const Command& command, const CommonOptions& common, const std::vector<std::string>& inputs) {
  std::vector<std::string> readers;
  if (is_stream(common.config)) readers.emplace_back("--config");
  for (const std::string& input : inputs) {
    if (!is_stream(input)) continue;
    if (!command.inputs.may_stream && !command.inputs.is_config) refuse_stream(command, command.inputs.name);
    readers.push_back(command.inputs.name);
  }
  for (const std::string& flag : streamed_flags(command)) {
    if (!takes_stream(command, flag)) refuse_stream(command, "--" + flag);
    readers.push_back("--" + flag);
  }
  if (readers.size() > 1) throw UsageError(join(readers, " and ") + " are \"-\"; standard input can be one of them");
  if (!is_stream(common.output)) return;
  if (command.output.stream_name.empty()) refuse_stream(command, "-o");
  if (common.json) throw UsageError("-o - and --json both go to standard output; give one of them");
}

OutputSpool::OutputSpool(const std::string& name)
    : folder_(temporary_folder()), file_((folder_.path() / name).string()) {}

}  // namespace pilotage
