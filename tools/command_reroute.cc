#include "cli_options.h"
#include "commands.h"

#include "pilotage/base/text.h"
#include "pilotage/mission/selection.h"
#include "pilotage/reroute/reroute.h"
#include "pilotage/reroute/reroute_files.h"

namespace pilotage {
namespace {

std::string line_text(const char* what, const RerouteLine& line) {
  return std::string(what) + " line: " + line.verdict_text + "\n";
}

std::string figures_text(const RerouteLine& line) {
  return format_fixed(line.length_m / 1000, 2) + " km, " + format_fixed(line.duration_s / 60, 1) + " min, " +
         std::to_string(line.turns) +
         " turns, P = " + (line.p_within_limit ? probability_text(*line.p_within_limit) : "unknown");
}

}  // namespace

Command make_reroute_command() {
  Command command;
  command.word = "reroute";
  command.group = CommandGroup::kPrepare;
  command.summary = "Find the cheapest line that is GO, and write its plan";
  command.examples = {
      {"Another line for the sample mission, by its waypoints.",
       "pilotage reroute maps/sample/mission.json --keep-waypoints -o out/better.plan"},
      {"From one place to another, around a zone.",
       "pilotage reroute maps/sample/mission.json --from 16.4860,55.4950 --to 16.5180,55.5040 --agl-m 120 --avoid "
       "zones.geojson -o out/direct.plan"}};
  command.inputs = {
      .name = "MISSION", .help = "Mission file of `prepare`: these options as JSON.", .max = 1, .is_config = true};
  command.output = {.kind = OutputKind::kFile,
                    .help =
                        "The new QGroundControl plan; figures, both lines and a page stand beside it as .json, "
                        ".geojson and .html.",
                    .files = [](const std::string& output) { return reroute_outputs(output); },
                    .stream_name = "standard-output.plan"};
  command.reads_rasters = true;
  bind_options<RerouteOptions>(command, [](const RerouteOptions& options, const Invocation& invocation) {
    const RerouteRun run{invocation.output, invocation.overwrite, invocation.seed, invocation.threads};
    const RerouteResult done = reroute(options, run, invocation.progress);
    CommandResult result;
    result.text = line_text("planned", done.before) + line_text("new", done.after) + done.assumptions + "\n" +
                  "planned: " + figures_text(done.before) + "\nnew: " + figures_text(done.after) +
                  "\ncost: " + cost_text(done) + "\n";
    if (!done.found_go) {
      result.text += "no line was found that is GO within " + format_fixed(done.search_within_m, 0) +
                     " m of the planned one; this is the best of " + std::to_string(done.lines_tried) + "\n";
    }
    for (const auto* items : {&done.lost_items, &done.shifted_items, &done.notes}) {
      for (const std::string& item : *items) result.text += item + "\n";
    }
    if (!invocation.prints_output) result.text += "page: " + reroute_outputs(run.output).back().string() + "\n";
    result.json = reroute_to_json(done);
    result.json["output"] = invocation.output;
    result.warnings = done.warnings;
    if (!done.found_go) result.exit_code = kExitGateNotMet;
    return result;
  });
  take_flags_away(command.options, {"outputs", "autopilot", "purpose"});  // of a mission file, for `prepare` alone
  return command;
}

}  // namespace pilotage
