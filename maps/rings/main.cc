// fly_rings -o FOLDER [--flights 20] [--seed 1]: maps/README.md; `fly_rings --help` lists the options.
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include "ring_report.h"
#include "run_program.h"

#include "pilotage/base/json_object.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/parallel.h"
#include "pilotage/base/random.h"

namespace pilotage {
namespace {

struct FlyRingsOptions {
  int flights = 1;
  RingFlightOptions flight;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("flights", self.flights, "How many, each over a field of its own.", Range{1, 1000});
    RingFlightOptions::describe(self.flight, fields);
  }
};

/// Of each flight by its number, whatever the threads. The first has the seed itself.
std::vector<RingFlight> fly_all(const RingField& field, const std::filesystem::path& map,
                                const FlyRingsOptions& options, const Invocation& invocation) {
  std::vector<RingFlight> flights(static_cast<std::size_t>(options.flights));
  parallel_for(flights.size(), invocation.threads, [&](std::size_t i, int) {
    MapReader reader = MapReader::open_unverified(map);
    flights[i] = fly_rings(field, reader, options.flight, i == 0 ? invocation.seed : derive_seed(invocation.seed, i));
    if (i == 0) return;
    for (std::vector<PathPoint>* path :
         {&flights[i].scan, &flights[i].with_fixes.path, &flights[i].without_fixes.path}) {
      path->clear();  // only the first is drawn
    }
  });
  return flights;
}

CommandResult run_fly_rings(const FlyRingsOptions& options, const Invocation& invocation) {
  const std::filesystem::path folder = invocation.output;
  std::filesystem::create_directories(folder);
  // Both are made ready before anything is computed, so that a folder that has them is refused at once.
  OutputFile json_file(folder / "rings.json", invocation.overwrite);
  OutputFile picture_file(folder / "rings.svg", invocation.overwrite);
  const RingField field = make_ring_field({}, invocation.threads);
  const std::filesystem::path map =
      prepare_ring_field(field, down_camera(), kLowest_m, kScanHeight_m, folder / "map", invocation.threads);
  const std::vector<RingFlight> flights = fly_all(field, map, options, invocation);
  CommandResult result;
  result.json = rings_json(flights, field.middle);
  result.text = rings_text(flights);
  json_file.write(json_text(result.json));
  picture_file.write(rings_svg(flights.front()));
  OutputFile::commit({&json_file, &picture_file}, {});
  return result;
}

Command make_fly_rings_command() {
  Command command;
  command.word = "fly_rings";
  command.group = CommandGroup::kInspect;
  command.summary = "Find rings, and fly through them in order without GNSS";
  command.examples = {{"One flight, with its picture.", "fly_rings -o rings"},
                      {"Twenty flights.", "fly_rings -o rings --flights 20"}};
  command.output = {.kind = OutputKind::kFolder, .help = "Folder for rings.json, rings.svg and the map."};
  bind_options<FlyRingsOptions>(command, run_fly_rings);
  return command;
}

}  // namespace
}  // namespace pilotage

int main(int argc, char** argv) {
  std::vector<std::string> arguments{"fly_rings"};
  arguments.insert(arguments.end(), argv + 1, argv + argc);
  return pilotage::run_program({pilotage::make_fly_rings_command()}, arguments, std::cout, std::cerr);
}
