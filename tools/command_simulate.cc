#include <filesystem>

#include "commands.h"
#include "stage_files.h"

#include "pilotage/base/json_object.h"
#include "pilotage/base/output_file.h"
#include "pilotage/mission/simulation_file.h"
#include "pilotage/simulate/flight_tracks.h"
#include "pilotage/simulate/simulate_flights.h"

namespace pilotage {
namespace {

struct SimulateCommandOptions {
  StageFileOptions files;
  SimulateOptions simulate;
  std::string tracks;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    StageFileOptions::describe(self.files, fields);
    SimulateOptions::describe(self.simulate, fields);
    fields.path("tracks", self.tracks,
                "Also write where the first 50 flights flew, and where 95 of 100 are, as .gpkg or .kml.");
  }
};

struct SimulatedFiles {
  StageFiles files;
  std::vector<InputFile> inputs;
};

/// A folder that `prepare` wrote stands for the files in it.
SimulatedFiles read_mission(const std::string& input, StageFileOptions files) {
  const bool is_folder = std::filesystem::is_directory(input);
  const std::filesystem::path plan =
      is_folder ? std::filesystem::path(input) / "plan.json" : std::filesystem::path(input);
  if (files.table.empty()) files.table = (plan.parent_path() / "tiles.csv").string();
  if (files.selection.empty()) files.selection = (plan.parent_path() / "selection.json").string();
  return {read_stage_files(plan.string(), files),
          {input_file("plan", plan.string(), ""), input_file("table", files.table, ""),
           input_file("selection", files.selection, "")}};
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
                       "simulation.json"}};
  command.inputs = {.name = "PLAN",
                    .help =
                        "The folder that prepare wrote, or the tile plan (plan.json); scores and selection are "
                        "those beside it, if not given.",
                    .min = 1,
                    .max = 1};
  command.output = {.kind = OutputKind::kFile,
                    .help = "The simulation (JSON).",
                    .flags = {"tracks"},
                    .stream_name = "simulation.json"};
  bind_options<SimulateCommandOptions>(
      command, [](const SimulateCommandOptions& options, const Invocation& invocation) {
        if (!options.tracks.empty()) check_track_file(options.tracks);
        const auto [files, inputs] = read_mission(invocation.inputs.front(), options.files);
        Simulation simulation = simulate_flights(files.mission, files.scores, files.selection, options.simulate,
                                                 invocation.seed, invocation.threads, invocation.progress);
        simulation.inputs = inputs;
        CommandResult result;
        result.json = simulation_to_json(simulation);
        OutputFile output(invocation.output, invocation.overwrite);
        output.write(json_text(result.json));
        if (!options.tracks.empty()) {
          write_flight_tracks(options.tracks, files.mission, simulation, invocation.overwrite);
        }
        output.commit();
        result.text = simulation_text(simulation);
        const std::optional<double>& required = options.simulate.require_simulated;
        if (required && simulation.within.interval.low < *required) result.exit_code = kExitGateNotMet;
        return result;
      });
  return command;
}

}  // namespace pilotage
