#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "commands.h"
#include "stage_files.h"

#include "pilotage/base/json_object.h"
#include "pilotage/base/output_file.h"
#include "pilotage/simulate/envelope.h"
#include "pilotage/simulate/envelope_file.h"

namespace pilotage {
namespace {

struct EnvelopeCommandOptions {
  StageFileOptions files;
  EnvelopeOptions envelope;
  std::string map;
  std::vector<std::string> also_map;
  std::string csv;
  std::string svg;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    StageFileOptions::describe(self.files, fields);
    EnvelopeOptions::describe(self.envelope, fields);
    fields.path("map", self.map, "The map; default map.gpkg beside the plan.");
    fields.path("also_map", self.also_map,
                "Another map of the ground, such as one of imagery of another date; each is asked. Repeat for more.");
    fields.path("csv", self.csv, "The cells as a table, too (CSV).");
    fields.path("svg", self.svg, "A drawing of the cells, too (SVG).");
  }
};

}  // namespace

Command make_envelope_command() {
  Command command;
  command.word = "envelope";
  command.group = CommandGroup::kPrepare;
  command.summary = "How far a flight may be off its plan, and how bad its frames";
  command.examples = {
      {"Against another date of the ground.",
       "pilotage envelope out --world later.tif --svg envelope.svg -o envelope.json"},
      {"Heights alone.", "pilotage envelope out --factors height_m --height-m 80:200:10 -o envelope.json"}};
  command.inputs = {.name = "PLAN",
                    .help =
                        "The folder that prepare wrote, or the tile plan (plan.json); scores, selection and map are "
                        "those beside it, if not given.",
                    .min = 1,
                    .max = 1};
  command.output = {.kind = OutputKind::kFile,
                    .help = "The envelope (JSON).",
                    .flags = {"csv", "svg"},
                    .stream_name = "envelope.json"};
  bind_options<EnvelopeCommandOptions>(
      command, [](const EnvelopeCommandOptions& options, const Invocation& invocation) {
        const std::filesystem::path plan = plan_of(invocation.inputs.front());
        const StageFiles files = read_stage_files(plan.string(), stage_files_beside(plan, options.files));
        const auto maps = asked_maps(map_beside(plan, options.map), options.also_map);
        std::vector<std::string> notes;
        for (const std::string& world : options.envelope.world) {
          for (const std::string& note : notes_of_world(world, maps)) notes.push_back(note);
        }
        Envelope envelope = make_envelope(files.mission, files.scores, files.selection, open_asked_maps(maps),
                                          options.envelope, invocation.seed, invocation.threads, invocation.progress);
        if (const std::string note = several_maps_note(maps); !note.empty()) envelope.notes.push_back(note);
        envelope.notes.insert(envelope.notes.end(), notes.begin(), notes.end());
        CommandResult result;
        result.json = envelope_to_json(envelope);
        OutputFile output(invocation.output, invocation.overwrite);
        output.write(json_text(result.json));
        std::vector<const OutputFile*> outputs;
        std::optional<OutputFile> csv;
        if (!options.csv.empty()) {
          csv.emplace(options.csv, invocation.overwrite).write(envelope_to_csv(envelope));
          outputs.push_back(&*csv);
        }
        std::optional<OutputFile> svg;
        if (!options.svg.empty()) {
          svg.emplace(options.svg, invocation.overwrite).write(envelope_to_svg(envelope));
          outputs.push_back(&*svg);
        }
        outputs.push_back(&output);
        OutputFile::commit(outputs, {});
        result.text = envelope_text(envelope);
        return result;
      });
  return command;
}

}  // namespace pilotage
