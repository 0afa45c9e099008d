#include <optional>

#include "commands.h"
#include "stage_files.h"

#include "pilotage/base/json_object.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/build_map/build_map.h"
#include "pilotage/mission/plan_file.h"
#include "pilotage/mission/selection_file.h"
#include "pilotage/select/route_ageing.h"
#include "pilotage/select/select_tiles.h"
#include "pilotage/verdict/map_holds.h"
#include "pilotage/verdict/verdict.h"

namespace pilotage {
namespace {

struct SelectCommandOptions {
  std::string table;
  std::optional<double> max_error_m;
  SelectOptions select;
  BuildOptions build;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.path("table", self.table, "The scores: tiles.csv of the plan.");
    fields.field("max_error_m", self.max_error_m, "Limit of the position error (k sigma), instead of the plan's.",
                 Range{1, 10000});
    SelectOptions::describe(self.select, fields);
    fields.group("build", self.build, "What build will store, for the budget.", FlagPrefix::kNone);
  }
};

std::string describe_gap(const RouteGap& gap) {
  return "gap from " + format_fixed(gap.from_distance_m / 1000, 2) + " km to " +
         format_fixed(gap.to_distance_m / 1000, 2) + " km (leg " + std::to_string(gap.leg + 1) +
         "): " + format_fixed(gap.to_distance_m - gap.from_distance_m, 0) + " m, " + format_fixed(gap.duration_s, 0) +
         " s, error " + format_fixed(gap.error_m, 1) + " m" + (gap.within_limit ? "" : ", over the limit") + "\n";
}

std::string describe_probability(const Selection& selection) {
  const RouteProbability& route = *selection.probability;
  std::string text = "within the limit all the way with P = " + probability_text(route.p_within_limit) +
                     (route.interval ? " (80 % interval " + probability_text(route.interval->low) + " … " +
                                           probability_text(route.interval->high) + ")"
                                     : "") +
                     (route.p_within_limit < route.min_p_within_limit ? ", below the " : ", at least the ") +
                     probability_text(route.min_p_within_limit) + " asked for; expected fixes " +
                     format_fixed(route.expected_fixes, 1) + ", false ones at most " +
                     format_fixed(route.expected_false_fixes, 4) + "\n";
  if (const auto& worst = route.worst) {
    text += "most flights are lost from " + format_fixed(worst->from_distance_m / 1000, 2) + " km to " +
            format_fixed(worst->to_distance_m / 1000, 2) + " km (leg " + std::to_string(worst->leg + 1) +
            "): " + format_fixed(100 * worst->p_first_excess, 2) + " % of all\n";
  }
  return text;
}

}  // namespace

Command make_select_command() {
  Command command;
  command.word = "select";
  command.group = CommandGroup::kStages;
  command.summary = "Choose the matching areas so that no gap is too long";
  command.examples = {{"All that can be matched.", "pilotage select plan.json --table tiles.csv -o selection.json"},
                      {"The fewest areas, or fail.",
                       "pilotage select plan.json --table tiles.csv --sparse --require -o selection.json"}};
  command.inputs = {.name = "PLAN", .help = "The tile plan (plan.json).", .min = 1, .max = 1};
  command.output = {.kind = OutputKind::kFile, .help = "The selection (JSON).", .stream_name = "selection.json"};
  bind_options<SelectCommandOptions>(command, [](const SelectCommandOptions& options, const Invocation& invocation) {
    Mission mission = read_stage_plan(invocation.inputs.front());
    mission.flight.max_error_m = options.max_error_m.value_or(mission.flight.max_error_m);
    const std::vector<TileScores> scores = read_scores(options.table, mission.ground, invocation.inputs.front());
    Selection selection =
        select_tiles(mission, scores, stored_size(options.build, mission.ground), options.select, invocation.threads);
    selection.ageing = age_route(mission, scores, selection, invocation.threads);
    write_file(invocation.output, json_text(selection_to_json(selection)), invocation.overwrite);

    CommandResult result;
    result.text = std::to_string(selection.tile_ids.size()) + " of " + std::to_string(mission.ground.tiles.size()) +
                  " tiles, at most " + format_fixed(static_cast<double>(selection.estimated_bytes) / 1e6, 2) +
                  " MB; matchable on " + format_fixed(100 * selection.matchable_fraction, 1) + " % of the route\n";
    for (const RouteGap& gap : selection.gaps) result.text += describe_gap(gap);
    if (selection.probability) result.text += describe_probability(selection);
    result.text += assumptions_line(mission, selection) + "\n";
    if (selection.ageing) result.text += ageing_sentence(mission, selection) + "\n";
    if (selection.loss_anywhere && !options.select.advise) result.text += selection.notes[1] + "\n";
    if (options.select.advise) {
      // The first note counts tiles.
      for (std::size_t i = 1; i < selection.notes.size(); ++i) result.text += selection.notes[i] + "\n";
    }
    result.json = selection_to_json(selection);
    result.json.erase("tile_ids");
    result.json.erase("error_profile");
    result.json.erase("left_out");
    result.json.erase("tries");
    result.json["assumptions"] = assumptions_line(mission, selection);
    result.json["selected_tiles"] = selection.tile_ids.size();
    if (options.select.require && !meets_gate(selection)) result.exit_code = kExitGateNotMet;
    return result;
  });
  return command;
}

}  // namespace pilotage
