#include <algorithm>
#include <cmath>
#include <filesystem>

#include "commands.h"
#include "simulate_serving.h"
#include "stage_files.h"

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/output_file.h"
#include "pilotage/simulate/simulate_flights.h"
#include "pilotage/simulate/simulation_file.h"

namespace pilotage {
namespace {

struct SimulateCommandOptions {
  StageFileOptions files;
  SimulateOptions simulate;
  ServeOptions serving;
  std::string world;
  int frame_width_px = 640;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    StageFileOptions::describe(self.files, fields);
    SimulateOptions::describe(self.simulate, fields);
    ServeOptions::describe(self.serving, fields);
    fields.path("world", self.world, "The ground that frames show, a raster of another date.");
    fields.field("frame_width_px", self.frame_width_px, "Frames are so wide.", Range{16, 10000});
  }
};

/// A folder that `prepare` wrote stands for the files in it.
std::filesystem::path plan_of(const std::string& input) {
  const std::filesystem::path path(input);
  return std::filesystem::is_directory(path) ? path / "plan.json" : path;
}

StageFiles read_mission(const std::filesystem::path& plan, StageFileOptions files) {
  if (files.table.empty()) files.table = (plan.parent_path() / "tiles.csv").string();
  if (files.selection.empty()) files.selection = (plan.parent_path() / "selection.json").string();
  return read_stage_files(plan.string(), files);
}

constexpr const char* kOutputHelp = "The simulation (JSON); none with --serve.";

CommandResult serve(const std::filesystem::path& plan, const SimulateCommandOptions& options,
                    const Invocation& invocation) {
  if (!invocation.output.empty()) throw UsageError("-o has no meaning with --serve, which flies nothing");
  const Mission mission = read_stage_plan(plan.string());
  const Camera& camera = mission.flight.camera;
  const int width_px = std::min(camera.width_px, options.frame_width_px);
  const int height_px = std::max(1, static_cast<int>(std::lround(1.0 * width_px * camera.height_px / camera.width_px)));
  return serve_airsim(mission, options.world, resized_camera(camera, width_px, height_px), options.serving,
                      invocation.progress);
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
  command.output = {
      .kind = OutputKind::kFile, .help = kOutputHelp, .required = false, .stream_name = "simulation.json"};
  bind_options<SimulateCommandOptions>(
      command, [](const SimulateCommandOptions& options, const Invocation& invocation) {
        const std::filesystem::path plan = plan_of(invocation.inputs.front());
        if (!options.serving.serve.empty()) return serve(plan, options, invocation);
        if (invocation.output.empty()) throw UsageError("-o OUTPUT is missing: " + std::string(kOutputHelp));
        const StageFiles files = read_mission(plan, options.files);
        const Simulation simulation = simulate_flights(files.mission, files.scores, files.selection, options.simulate,
                                                       invocation.seed, invocation.threads, invocation.progress);
        CommandResult result;
        result.json = simulation_to_json(simulation);
        write_file(invocation.output, json_text(result.json), invocation.overwrite);
        result.text = simulation_text(simulation);
        const std::optional<double>& required = options.simulate.require_simulated;
        if (required && simulation.within.interval.low < *required) result.exit_code = kExitGateNotMet;
        return result;
      });
  return command;
}

}  // namespace pilotage
