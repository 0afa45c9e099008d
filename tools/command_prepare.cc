#include "commands.h"
#include "map_delta_result.h"
#include "map_size.h"
#include "sign_key_options.h"
#include "stage_files.h"
#include "version.h"

#include "pilotage/base/text.h"
#include "pilotage/mapdb/map_delta.h"
#include "pilotage/mapdb/map_signature.h"
#include "pilotage/prepare/prepare.h"

namespace pilotage {
namespace {

struct PrepareCommandOptions {
  PrepareOptions prepare;
  SignKeyOptions signing;
  std::string update;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    PrepareOptions::describe(self.prepare, fields);
    SignKeyOptions::describe(self.signing, fields);
    fields.path("update", self.update, kUpdateHelp);
  }
};

}  // namespace

Command make_prepare_command() {
  Command command;
  command.word = "prepare";
  command.group = CommandGroup::kPrepare;
  command.summary = "Imagery and a route in, map database and report out";
  command.examples = {{"The sample mission.", "pilotage prepare maps/sample/mission.json -o out/"},
                      {"Everything on the command line.",
                       "pilotage prepare --imagery ortho.tif --route route.plan --agl-m 120 --camera-hfov-deg 73.7 "
                       "--camera-width-px 4000 --camera-height-px 2250 --ins-grade tactical --speed-mps 18 -o out/"}};
  command.inputs = {.name = "MISSION", .help = "Mission file: these options as JSON.", .max = 1, .is_config = true};
  command.output = {.kind = OutputKind::kFolder,
                    .help =
                        "Folder for map.gpkg, scores.tif, tiles.csv, the files of the report (--outputs), and "
                        "plan.json and selection.json, from which the stages can be run again, and simulation.json.",
                    .files = [](const std::string& folder) {
                      std::vector<std::filesystem::path> files;
                      for (const std::string& name : earlier_outputs(folder)) {
                        files.push_back(std::filesystem::path(folder) / name);
                      }
                      return files;
                    }};
  command.reads_rasters = true;
  bind_options<PrepareCommandOptions>(command, [](const PrepareCommandOptions& given, const Invocation& invocation) {
    const PrepareOptions& options = given.prepare;
    const SignKeyOptions& signing = given.signing;
    PrepareRun run{invocation.output, invocation.overwrite,         invocation.seed, invocation.threads, version_line(),
                   signing.sign_key,  checked_sign_options(signing)};
    if (!given.update.empty()) {
      need_file(given.update, "build` or `pilotage prepare");
      run.update = given.update;
    }
    const PrepareResult done = prepare(options, run, invocation.progress);
    CommandResult result;
    const std::string folder = invocation.output;
    result.text = done.verdict + "\n" + done.assumptions + "\n" + done.evidence + "\n" +
                  (done.holds.empty() ? "" : done.holds + "\n") + std::to_string(done.planned_tiles) + " tiles, " +
                  std::to_string(done.selected_tiles) + " stored with " + std::to_string(done.map.descriptors) +
                  " descriptors, " + format_fixed(static_cast<double>(done.map.bytes) / 1e6, 2) + " MB\n" +
                  bytes_per_tile_text(done.map) + kept_features_text(done.map);
    if (asks_for(options.outputs, ReportOutput::kPack)) {
      result.text += "field pack: " + folder + ", check it by `pilotage verify " + folder + "`\n";
    }
    if (signing.sign_key) {
      result.text += "signed: " + signature_path_of(std::filesystem::path(folder) / "map.gpkg").string() + "\n";
    }
    if (asks_for(outputs_of(options), ReportOutput::kHtml)) {
      result.text += "report: " + (std::filesystem::path(folder) / "report.html").string() + "\n";
    }
    result.json = {{"verdict", done.verdict},
                   {"assumptions", done.assumptions},
                   {"evidence", done.evidence},
                   {"output", folder},
                   {"files", done.files},
                   {"tiles", done.planned_tiles},
                   {"selected_tiles", done.selected_tiles},
                   {"descriptors", done.map.descriptors},
                   {"map_bytes", done.map.bytes},
                   {"map_digest", done.map.content_digest},
                   {"matchable_fraction", done.matchable_fraction},
                   {"within_limit", done.within_limit}};
    if (!done.holds.empty()) result.json["holds"] = done.holds;
    add_bytes_per_tile(done.map, result.json);
    add_kept_features(done.map, result.json);
    if (run.update) {
      add_map_delta(given.update, std::filesystem::path(folder) / map_delta_path_of("map.gpkg"), done.difference,
                    result);
    }
    result.warnings = done.warnings;
    if (options.select.require && !done.meets_gate) result.exit_code = kExitGateNotMet;
    return result;
  });
  return command;
}

}  // namespace pilotage
