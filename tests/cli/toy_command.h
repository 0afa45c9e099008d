#pragma once

#include <chrono>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "command.h"

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"

namespace pilotage {

enum class Fate {
  kDone,
  kGate,
  kDataError,
  kUsageError,
  kIntegrityError,
  kNoMemory,
  kOther,
  kStopped,
  kEndless,
  kDeaf
};
inline EnumNames<Fate> enum_names(Fate) {
  return {{Fate::kDone, "done"},
          {Fate::kGate, "gate"},
          {Fate::kDataError, "data"},
          {Fate::kUsageError, "usage"},
          {Fate::kIntegrityError, "integrity"},
          {Fate::kNoMemory, "memory"},
          {Fate::kOther, "other"},
          {Fate::kStopped, "stopped"},
          {Fate::kEndless, "endless"},
          {Fate::kDeaf, "deaf"}};
}

struct ToyCamera {
  double hfov_deg = 60;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("hfov_deg", self.hfov_deg, "Horizontal field of view.", Range{1, 179});
  }
};

/// One field of every kind.
struct ToyOptions {
  int size_px = 256;
  double offset_m = 0;
  bool loud = false;
  bool check = true;
  Fate fate = Fate::kDone;
  std::optional<double> speed_mps;
  std::string name;
  std::vector<double> steps;
  std::vector<Fate> fates{Fate::kDone};
  std::vector<std::string> imagery;
  std::optional<std::string> elevation;
  ToyCamera camera;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("size_px", self.size_px, "Side of a tile.", Range{16, 4096});
    fields.field("offset_m", self.offset_m, "To the east.");
    fields.field("loud", self.loud, "Say more.");
    fields.field("check", self.check, "Look twice.");
    fields.field("fate", self.fate, "How it ends.");
    fields.field("speed_mps", self.speed_mps, "Speed over ground.", Range{0, 400});
    fields.field("name", self.name, "What to call it.");
    fields.field("steps", self.steps, "Where to stop.", Range{-1, 1});
    fields.field("fates", self.fates, "Several.");
    fields.path("imagery", self.imagery, "Rasters.");
    fields.path("elevation", self.elevation, "Heights.");
    fields.group("camera", self.camera, "How the aircraft sees the ground");
  }
};

/// Has an output half written, and works until somebody stops it; `deaf`: asks nobody whether to stop, and writes.
[[noreturn]] inline void work_for_ever(const Invocation& invocation, bool deaf) {
  const OutputFile output(invocation.output, invocation.overwrite);
  std::ofstream(output.temporary_path()) << "half";
  for (std::int64_t done = 0;; ++done) {
    if (!deaf || done == 0) report_progress(invocation.progress, "toying", done, 0);
    if (deaf) std::ofstream(output.temporary_path().string() + std::to_string(done)) << "more";
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

/// A command with a way to end in every way a command can.
inline Command make_toy_command() {
  Command command;
  command.word = "toy";
  command.summary = "Does nothing in every possible way";
  command.examples = {{"The usual.", "pilotage toy a.tif -o b.tif"}};
  command.inputs = {.name = "RASTER", .help = "The imagery.", .min = 1, .max = 2};
  command.output = {.kind = OutputKind::kFile, .help = "The toy.", .required = false};
  bind_options<ToyOptions>(command, [](const ToyOptions& options, const Invocation& invocation) -> CommandResult {
    switch (options.fate) {
      case Fate::kDataError:
        throw DataError("a.tif: is broken");
      case Fate::kUsageError:
        throw UsageError("size_px = 3 is odd");
      case Fate::kIntegrityError:
        throw IntegrityError("map.gpkg: wrong digest");
      case Fate::kNoMemory:
        throw std::bad_alloc();
      case Fate::kOther:
        throw std::logic_error("oops");
      case Fate::kStopped:
        throw Interrupted{};
      default:
        break;
    }
    if (options.fate == Fate::kEndless || options.fate == Fate::kDeaf) {
      work_for_ever(invocation, options.fate == Fate::kDeaf);
    }
    report_progress(invocation.progress, "toying", 1, 1);
    CommandResult result;
    result.exit_code = options.fate == Fate::kGate ? kExitGateNotMet : kExitDone;
    result.text = "size " + std::to_string(options.size_px) + "\n";
    result.json = {{"size_px", options.size_px},
                   {"inputs", invocation.inputs},
                   {"threads", invocation.threads},
                   {"seed", invocation.seed}};
    result.warnings = {"small"};
    return result;
  });
  return command;
}

}  // namespace pilotage
