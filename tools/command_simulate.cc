#include <filesystem>
#include <optional>
#include <utility>

#include "commands.h"
#include "simulate_serving.h"
#include "stage_files.h"

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/output_file.h"
#include "pilotage/mission/simulation_file.h"
#include "pilotage/simulate/airsim_frames.h"
#include "pilotage/simulate/fix_log.h"
#include "pilotage/simulate/flight_tracks.h"
#include "pilotage/simulate/rendered_fixes.h"
#include "pilotage/simulate/simulate_flights.h"

namespace pilotage {
namespace {

struct SimulateCommandOptions {
  StageFileOptions files;
  SimulateOptions simulate;
  RenderedOptions rendered;
  std::string log;
  std::string tracks;
  AirsimFrameOptions airsim;
  ServeOptions serving;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    StageFileOptions::describe(self.files, fields);
    SimulateOptions::describe(self.simulate, fields);
    RenderedOptions::describe(self.rendered, fields);
    fields.path("log", self.log, "With rendered fixes: the table of all tries and their answers (fixes.csv).");
    fields.path("tracks", self.tracks,
                "Also write where the first 50 flights flew, and where 95 of 100 are, as .gpkg or .kml.");
    AirsimFrameOptions::describe(self.airsim, fields);
    ServeOptions::describe(self.serving, fields);
  }
};

void refuse_without_frames(const SimulateCommandOptions& options) {
  if (!options.rendered.also_map.empty()) throw UsageError("--also-map has no meaning without --fixes rendered");
  for (const auto& [flag, value] : {std::pair{"--world", options.rendered.world},
                                    {"--world-elevation", options.rendered.world_elevation},
                                    {"--map", options.rendered.map},
                                    {"--log", options.log}}) {
    if (!value.empty()) throw UsageError(std::string(flag) + " has no meaning without --fixes rendered");
  }
}

RenderedWorld world_of(const Mission& mission, const RenderedOptions& options) {
  return make_rendered_world(mission, options.world, options.world_elevation);
}

constexpr const char* kOutputHelp = "The simulation (JSON); none with --serve.";

CommandResult serve(const std::filesystem::path& plan, const SimulateCommandOptions& options,
                    const Invocation& invocation) {
  if (!invocation.output.empty()) throw UsageError("-o has no meaning with --serve, which flies nothing");
  const Mission mission = read_stage_plan(plan.string());
  return serve_airsim(mission, world_of(mission, options.rendered), rendered_camera(mission, options.rendered),
                      options.serving, invocation);
}

/// A simulation, and the words that are for people alone.
struct Flown {
  Simulation simulation;
  std::string text;
  std::string log;  ///< For --log: the tries as a table.
  std::vector<std::string> warnings;
};

/// Flies with frames of a source and the matcher on the map.
Flown fly_frames(const StageFiles& files, const std::filesystem::path& plan, const SimulateCommandOptions& options,
                 FrameSource frames, const Invocation& invocation) {
  const auto maps = asked_maps(map_beside(plan, options.rendered.map), options.rendered.also_map);
  if (const std::string note = several_maps_note(maps); !note.empty()) frames.notes.push_back(note);
  for (const std::string& note : notes_of_world(options.rendered.world, maps)) frames.notes.push_back(note);
  RenderedFixes fixes(files.mission, options.simulate, options.rendered, frames, open_asked_maps(maps),
                      invocation.threads);
  Flown flown{simulate_flights(files.mission, files.scores, files.selection, options.simulate, invocation.seed,
                               invocation.threads, invocation.progress, fixes.source()),
              "",
              "",
              {}};
  const std::vector<SimulatedTry> tries = fixes.take_tries();
  const MatchEvaluation matches = evaluate_tries(tries, options.rendered);
  flown.simulation.rendered = rendered_json(options.rendered, matches);
  flown.text = evaluation_text(matches);
  flown.warnings = warnings_of_maps(matches_of(tries), maps);
  for (const std::string& warning : lean_warnings(matches.lean, options.rendered.match)) {
    flown.warnings.push_back(warning);
  }
  if (!options.log.empty()) flown.log = fix_log_to_csv(tries);
  return flown;
}

Flown fly(const StageFiles& files, const std::filesystem::path& plan, const SimulateCommandOptions& options,
          const Invocation& invocation) {
  const bool by_airsim = options.simulate.fixes == FixesFrom::kAirsim;
  if (by_airsim != !options.airsim.airsim.empty()) {
    throw UsageError("--fixes airsim and --airsim HOST:PORT have no meaning without each other");
  }
  const Camera camera = rendered_camera(files.mission, options.rendered);
  if (by_airsim) {
    for (const auto& [flag, value] :
         {std::pair{"--world", options.rendered.world}, {"--world-elevation", options.rendered.world_elevation}}) {
      if (!value.empty()) {
        throw UsageError(std::string(flag) + " has no meaning with --fixes airsim: the server has a world");
      }
    }
    return fly_frames(files, plan, options, airsim_frames(files.mission, camera, options.airsim, invocation.go_on),
                      invocation);
  }
  if (options.simulate.fixes == FixesFrom::kRendered) {
    const RenderedWorld world = world_of(files.mission, options.rendered);
    return fly_frames(files, plan, options, rendered_frames(world, camera), invocation);
  }
  refuse_without_frames(options);
  return {simulate_flights(files.mission, files.scores, files.selection, options.simulate, invocation.seed,
                           invocation.threads, invocation.progress),
          "",
          "",
          {}};
}

/// The simulation, and what else is asked for, which all appear at once.
void write_outputs(const Flown& flown, const std::string& json, const Mission& mission,
                   const SimulateCommandOptions& options, const Invocation& invocation) {
  std::vector<const OutputFile*> outputs;
  std::optional<OutputFile> log;
  if (!options.log.empty()) {
    log.emplace(options.log, invocation.overwrite).write(flown.log);
    outputs.push_back(&*log);
  }
  std::optional<OutputFile> tracks;
  if (!options.tracks.empty()) {
    tracks.emplace(options.tracks, invocation.overwrite);
    write_flight_tracks(tracks->temporary_path(), mission, flown.simulation, true);
    outputs.push_back(&*tracks);
  }
  OutputFile output(invocation.output, invocation.overwrite);
  output.write(json);
  outputs.push_back(&output);
  OutputFile::commit(outputs, {});
}

CommandResult run_simulate(const SimulateCommandOptions& options, const Invocation& invocation) {
  if (!options.tracks.empty()) check_track_file(options.tracks);
  const std::filesystem::path plan = plan_of(invocation.inputs.front());
  if (!options.serving.serve.empty()) return serve(plan, options, invocation);
  if (invocation.output.empty()) throw UsageError("-o OUTPUT is missing: " + std::string(kOutputHelp));
  const StageFileOptions names = stage_files_beside(plan, options.files);
  const StageFiles files = read_stage_files(plan.string(), names);
  Flown flown = fly(files, plan, options, invocation);
  Simulation& simulation = flown.simulation;
  simulation.inputs = simulated_inputs(plan.string(), names.table, names.selection);
  CommandResult result;
  result.json = simulation_to_json(simulation);
  write_outputs(flown, json_text(result.json), files.mission, options, invocation);
  result.text = simulation_text(simulation) + flown.text;
  result.warnings = std::move(flown.warnings);
  const std::optional<double>& required = options.simulate.require_simulated;
  if (required && simulation.within.interval().low < *required) result.exit_code = kExitGateNotMet;
  return result;
}

}  // namespace

Command make_simulate_command() {
  Command command;
  command.word = "simulate";
  command.group = CommandGroup::kPrepare;
  command.summary = "Fly a mission many times without GNSS, and count what happens";
  command.examples = {{"A thousand flights of what prepare wrote.", "pilotage simulate out -o simulation.json"},
                      {"GNSS is lost at 2 km, and nine flights of ten must stay within the limit.",
                       "pilotage simulate out --lost-from-km 2 --flights 10000 --require-simulated 0.9 -o "
                       "simulation.json"},
                      {"Twenty flights whose frames show another date, matched as on board.",
                       "pilotage simulate out --fixes rendered --world later.tif --flights 20 -o rendered.json"}};
  command.inputs = {.name = "PLAN",
                    .help =
                        "The folder that prepare wrote, or the tile plan (plan.json); scores and selection are "
                        "those beside it, if not given.",
                    .min = 1,
                    .max = 1};
  command.output = {.kind = OutputKind::kFile,
                    .help = kOutputHelp,
                    .required = false,
                    .flags = {"log", "tracks"},
                    .stream_name = "simulation.json"};
  bind_options<SimulateCommandOptions>(command, run_simulate);
  return command;
}

}  // namespace pilotage
