#include "cli_options.h"
#include "commands.h"

#include "pilotage/base/json_object.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/mission/plan_file.h"
#include "pilotage/prepare/prepare.h"
#include "pilotage/tile/plan_tiles.h"

namespace pilotage {

Command make_tile_command() {
  Command command;
  command.word = "tile";
  command.group = CommandGroup::kStages;
  command.summary = "Cut the corridor into tiles the size of the footprint";
  command.examples = {{"The sample mission.", "pilotage tile maps/sample/mission.json -o plan.json"}};
  command.inputs = {.name = "MISSION", .help = "Mission file: these options as JSON.", .max = 1, .is_config = true};
  command.output = {.kind = OutputKind::kFile, .help = "The tile plan (JSON).", .stream_name = "plan.json"};
  command.reads_rasters = true;
  bind_options<PrepareOptions>(command, [](const PrepareOptions& options, const Invocation& invocation) {
    const Mission mission = plan_tiles(options.tile, invocation.progress);
    write_file(invocation.output, json_text(plan_to_json(mission)), invocation.overwrite);
    CommandResult result;
    result.text = std::to_string(mission.ground.tiles.size()) + " tiles in " +
                  std::to_string(mission.ground.levels.size()) + " level(s), " + mission.ground.crs.name() + "\n";
    result.json = {
        {"output", invocation.output}, {"crs", mission.ground.crs.name()}, {"tiles", mission.ground.tiles.size()}};
    for (const GridLevel& level : mission.ground.levels) {
      result.text += "level " + std::to_string(level.matrix.level) + ": " + format_fixed(level.gsd_m, 3) +
                     " m/px, tiles of " + std::to_string(level.matrix.tile_size_px) + " px every " +
                     std::to_string(level.matrix.stride_px) + " px, search " + std::to_string(level.search_radius_px) +
                     " px, " + format_fixed(level.min_agl_m, 0) + " to " + format_fixed(level.max_agl_m, 0) +
                     " m above ground\n";
      result.json["levels"].push_back({{"level", level.matrix.level},
                                       {"gsd_m", level.gsd_m},
                                       {"tile_size_px", level.matrix.tile_size_px},
                                       {"stride_px", level.matrix.stride_px},
                                       {"search_radius_px", level.search_radius_px}});
    }
    for (const auto& note : mission.notes) result.text += note + "\n";
    result.json["notes"] = mission.notes;
    result.warnings = mission.warnings;
    return result;
  });
  // A mission file says what the later stages do, too.
  take_flags_away(command.options, {"score", "select", "build", "purpose", "flights", "outputs"});
  return command;
}

}  // namespace pilotage
