#include "commands.h"

#include "pilotage/base/json_object.h"
#include "pilotage/base/text.h"
#include "pilotage/landmark/label_landmarks.h"

namespace pilotage {
namespace {

const char* kCompleteLabels =
    "everything of these classes that the imagery shows is labelled; what is not would be learnt as background";

std::string result_text(const LabelledChips& chips, const std::string& folder) {
  std::string text;
  for (const LabelledClass& one : chips.classes) {
    text += one.class_name + ": " + std::to_string(one.labels) + " labels, " + format_fixed(one.shortest_m, 1) +
            " to " + format_fixed(one.longest_m, 1) + " m long (median " + format_fixed(one.median_m, 1) + " m, " +
            format_fixed(one.median_m / chips.gsd_m, 0) + " px)\n";
  }
  if (chips.merged > 0) text += std::to_string(chips.merged) + " labels of what another one had labelled: left out\n";
  if (chips.outside > 0) text += std::to_string(chips.outside) + " not wholly on ground that is shown: left out\n";
  if (chips.other_date > 0) text += std::to_string(chips.other_date) + " of another date: left out\n";
  text += std::to_string(chips.background_chips) + " chips of background; " + std::to_string(chips.files.size()) +
          " files in " + folder + ", " + format_fixed(chips.gsd_m, 4) + " m a pixel in " + chips.crs.name() + "\n";
  return text + "assumes: " + kCompleteLabels + "\n";
}

nlohmann::ordered_json result_json(const LabelledChips& chips, const std::string& folder) {
  nlohmann::ordered_json classes = nlohmann::ordered_json::array();
  for (const LabelledClass& one : chips.classes) {
    classes.push_back({{"class", one.class_name},
                       {"labels", one.labels},
                       {"shortest_m", one.shortest_m},
                       {"median_m", one.median_m},
                       {"longest_m", one.longest_m}});
  }
  return {{"output", folder},
          {"annotations", kChipAnnotations},
          {"shapes", kLabelShapes},
          {"crs", chips.crs.name()},
          {"gsd_m", chips.gsd_m},
          {"classes", classes},
          {"background_chips", chips.background_chips},
          {"merged", chips.merged},
          {"outside", chips.outside},
          {"other_date", chips.other_date},
          {"assumptions", {kCompleteLabels}}};
}

}  // namespace

Command make_landmark_label_command() {
  Command command;
  command.word = "landmark-label";
  command.group = CommandGroup::kLandmarks;
  command.summary = "Cut chips of landmarks that are labelled on imagery";
  command.examples = {
      {"Storage tanks of an OpenStreetMap extract; what lies outside of the imagery is left out.",
       "pilotage landmark-label ortho.tif --labels extract.osm --class-field man_made --classes storage_tank --unfit "
       "skip -o chips"},
      {"Roofs drawn in QGIS, on the grid of a plan.",
       "pilotage landmark-label plan.json --labels roofs.gpkg --class roof -o chips"},
      {"The same landmarks on imagery of another date.",
       "pilotage landmark-label last_year.tif --labels chips/labels.geojson -o chips_last_year"}};
  command.inputs = {.name = "IMAGERY",
                    .help = "GDAL datasets, later ones on top, or one tile plan (plan.json).",
                    .min = 1,
                    .max = InputSpec::kMany};
  command.output = {.kind = OutputKind::kFolder,
                    .help = "Folder for the chips (PNG), their annotations labels.xml and the labels labels.geojson."};
  command.reads_rasters = true;
  bind_options<LabelOptions>(command, [](const LabelOptions& options, const Invocation& invocation) {
    const LabelledChips chips = label_landmarks(invocation.inputs, options, invocation.output, invocation.overwrite,
                                                invocation.seed, invocation.progress);
    CommandResult result;
    result.text = result_text(chips, invocation.output);
    result.json = result_json(chips, invocation.output);
    result.warnings = chips.warnings;
    return result;
  });
  return command;
}

}  // namespace pilotage
