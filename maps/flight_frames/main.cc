// cut_flight_frames RASTER -o FOLDER --frames 500 --seed 1 --footprint-m 154
// What is written is said in cut_flight_frames.h; `cut_flight_frames --help` lists the options.
#include <iostream>
#include <string>
#include <vector>

#include "cut_flight_frames.h"
#include "run_program.h"

#include "pilotage/base/text.h"

namespace pilotage {
namespace {

CommandResult run_cut(const FlightFrameOptions& options, const Invocation& invocation) {
  const double agl_m = cut_flight_frames(invocation.inputs.front(), invocation.output, options, invocation.seed,
                                         invocation.threads, invocation.overwrite);
  CommandResult result;
  result.text = std::to_string(options.frames) + " frames from " + format_fixed(agl_m, 1) + " m above ground\n";
  result.json = {{"output", invocation.output}, {"frames", options.frames}, {"agl_m", agl_m}};
  return result;
}

Command make_cut_command() {
  Command command;
  command.word = "cut_flight_frames";
  command.group = CommandGroup::kInspect;
  command.summary = "Cut camera frames with known truth from imagery";
  command.examples = {{"Frames 154 m wide.", "cut_flight_frames ortho.tif -o frames --frames 500 --footprint-m 154"}};
  command.inputs = {.name = "RASTER", .help = "Georeferenced imagery: a GDAL dataset.", .min = 1, .max = 1};
  command.output = {.kind = OutputKind::kFolder, .help = "Folder for camera.yaml, frames.csv and the frames."};
  bind_options<FlightFrameOptions>(command, run_cut);
  return command;
}

}  // namespace
}  // namespace pilotage

int main(int argc, char** argv) {
  std::vector<std::string> arguments{"cut_flight_frames"};
  arguments.insert(arguments.end(), argv + 1, argv + argc);
  return pilotage::run_program({pilotage::make_cut_command()}, arguments, std::cout, std::cerr);
}
