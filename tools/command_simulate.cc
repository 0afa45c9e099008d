#include <filesystem>

#include "commands.h"
#include "stage_files.h"

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/output_file.h"
#include "pilotage/simulate/fix_log.h"
#include "pilotage/simulate/rendered_fixes.h"
#include "pilotage/simulate/simulate_flights.h"
#include "pilotage/simulate/simulation_file.h"

namespace pilotage {
namespace {

struct SimulateCommandOptions {
  StageFileOptions files;
  SimulateOptions simulate;
  RenderedOptions rendered;
  std::string log;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    StageFileOptions::describe(self.files, fields);
    SimulateOptions::describe(self.simulate, fields);
    RenderedOptions::describe(self.rendered, fields);
    fields.path("log", self.log, "With rendered fixes: the table of all tries and their answers (fixes.csv).");
  }
};

void refuse_without_frames(const SimulateCommandOptions& options) {
  for (const auto& [flag, value] :
       {std::pair{"--world", options.rendered.world}, {"--map", options.rendered.map}, {"--log", options.log}}) {
    if (!value.empty()) throw UsageError(std::string(flag) + " has no meaning without --fixes rendered");
  }
}

/// Flies with frames of a rendered world and the matcher on the map.
Simulation fly_rendered(const StageFiles& files, const std::filesystem::path& plan,
                        const SimulateCommandOptions& options, const Invocation& invocation) {
  const std::filesystem::path map = map_beside(plan, options.rendered.map);
  const RenderedWorld world = make_rendered_world(files.mission, options.rendered.world);
  const Camera camera = rendered_camera(files.mission, options.rendered);
  RenderedFixes fixes(
      files.mission, options.simulate, options.rendered, rendered_frames(world, camera),
      [map] { return MapReader::open_unverified(map); }, invocation.threads);
  Simulation simulation = simulate_flights(files.mission, files.scores, files.selection, options.simulate,
                                           invocation.seed, invocation.threads, invocation.progress, fixes.source());
  const std::vector<SimulatedTry> tries = fixes.take_tries();
  std::vector<FrameMatch> matches;
  for (const SimulatedTry& tried : tries) matches.push_back(tried.match);
  simulation.rendered = {options.rendered, evaluate_matches(matches, options.rendered.correct_within_m)};
  if (!options.log.empty()) write_file(options.log, fix_log_to_csv(tries), invocation.overwrite);
  return simulation;
}

Simulation fly(const StageFiles& files, const std::filesystem::path& plan, const SimulateCommandOptions& options,
               const Invocation& invocation) {
  if (options.simulate.fixes == FixesFrom::kRendered) return fly_rendered(files, plan, options, invocation);
  refuse_without_frames(options);
  return simulate_flights(files.mission, files.scores, files.selection, options.simulate, invocation.seed,
                          invocation.threads, invocation.progress);
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
  command.output = {
      .kind = OutputKind::kFile, .help = "The simulation (JSON).", .flags = {"log"}, .stream_name = "simulation.json"};
  bind_options<SimulateCommandOptions>(command,
                                       [](const SimulateCommandOptions& options, const Invocation& invocation) {
                                         const std::filesystem::path plan = plan_of(invocation.inputs.front());
                                         const StageFiles files = read_stage_files_beside(plan, options.files);
                                         const Simulation simulation = fly(files, plan, options, invocation);
                                         CommandResult result;
                                         result.json = simulation_to_json(simulation);
                                         write_file(invocation.output, json_text(result.json), invocation.overwrite);
                                         result.text = simulation_text(simulation);
                                         const std::optional<double>& required = options.simulate.require_simulated;
                                         if (required && simulation.within.interval.low < *required)
                                           result.exit_code = kExitGateNotMet;
                                         return result;
                                       });
  return command;
}

}  // namespace pilotage
