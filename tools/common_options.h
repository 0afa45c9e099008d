#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "command.h"
#include "progress_meter.h"

#include "pilotage/base/options.h"

namespace pilotage {

/// The flags that every command takes.
struct CommonOptions {
  std::string output;
  bool overwrite = false;
  std::string config;
  bool print_config = false;
  bool print_schema = false;
  bool json = false;
  int threads = 0;
  std::uint64_t seed = 1;
  bool quiet = false;
  ProgressMode progress = ProgressMode::kAuto;
  std::vector<std::string> gdal_config;
  bool allow_network = false;
  bool allow_any_vrt = false;
  std::vector<std::string> gdal_driver;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.path("output", self.output, "Where the result goes.");
    fields.field("overwrite", self.overwrite, "Replace outputs that exist.");
    fields.path("config", self.config, "Options from a JSON file; the command line wins over it.");
    fields.field("print_config", self.print_config, "Print the options in effect as JSON and stop.");
    fields.field("print_schema", self.print_schema, "Print the JSON Schema of the configuration file and stop.");
    fields.field("json", self.json, "Print the result, or the error, as JSON on standard output.");
    fields.field("threads", self.threads, "Threads to use; 0 takes all cores. Results do not depend on it.",
                 Range{0, 1024});
    fields.field("seed", self.seed, "Seed of everything random.");
    fields.field("quiet", self.quiet, "Only errors on standard error.");
    fields.field("progress", self.progress, "Progress on standard error: a bar when it is a terminal, or JSON lines.");
    fields.path("gdal_config", self.gdal_config, "A configuration option for GDAL, KEY=VALUE.");
    fields.field("allow_network", self.allow_network,
                 "Let rasters be read over the network: /vsicurl/ and its like, WMS, WMTS, WCS.");
    fields.field("allow_any_vrt", self.allow_any_vrt,
                 "Let VRTs have raw bands, and sources outside the folder they stand in.");
    fields.field("gdal_driver", self.gdal_driver,
                 "Open rasters by this driver of GDAL, too (its short name), which may then do what it likes.");
  }
};

/// The fields of `common` that make sense for `command`: no output flags where it has no output, nothing about rasters
/// where it reads none, and none that the command's own options describe themselves ("seed", "threads"). None of them
/// can stand in a configuration file: who sends a mission does not decide what it may reach.
OptionList common_fields_for(const Command& command, CommonOptions& common);

/// The one-letter form of a flag ("output" → "o"), or "".
std::string short_flag(const std::string& flag);

}  // namespace pilotage
