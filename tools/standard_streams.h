#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "command.h"
#include "common_options.h"

#include "pilotage/base/read_file.h"
#include "pilotage/base/work_folder.h"

namespace pilotage {

/// What stands for standard input or standard output (docs/decisions/standard-streams.md).
inline constexpr std::string_view kStandardStream = "-";

/// All of standard input. Throws DataError when it is longer than `max_bytes` or cannot be read.
std::string read_standard_input(std::uintmax_t max_bytes);

/// A file, or standard input for "-". Throws DataError.
std::string read_named_input(const std::string& path);

/// A configuration file into the fields of `list` (base/config_file.h); that of standard input lies in the current
/// folder.
void load_named_config(const OptionList& list, const std::string& path);

/// Throws UsageError for a "-" where it is neither standard input nor standard output, naming where it would be; for
/// two that would read standard input; and for --json beside an output that goes to standard output. `inputs` are the
/// arguments without a flag.
void check_streams(const Command& command, const CommonOptions& common, const std::vector<std::string>& inputs);

/// Where an output is written that is then printed: its kind is told by its name, and it is printed only when it is
/// whole.
class OutputSpool {
 public:
  /// Throws DataError when the folder for temporary files takes none.
  explicit OutputSpool(const std::string& name);

  std::string file() const { return file_; }

 private:
  WorkFolder folder_;
  std::string file_;
};

}  // namespace pilotage
