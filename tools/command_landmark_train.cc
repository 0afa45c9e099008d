#include "commands.h"

#include "pilotage/base/json_object.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/landmark/landmark_files.h"
#include "pilotage/landmark/train_landmarks.h"

namespace pilotage {
namespace {

std::vector<std::string> training_assumptions() {
  return {"everything of these classes that the chips show is labelled",
          "average precision, recall and precision are measured on ground left out, on chips of the same imagery and "
          "dates: of other imagery nothing is known until `pilotage landmark-score` has seen it"};
}

std::string result_text(const LandmarkModel& model) {
  std::string text;
  for (const auto& [detector, places, quality] : model.detectors) {
    text += detector.class_name + ": " + std::to_string(places.size()) + " labels of " +
            format_fixed(detector.shortest_m, 1) + " to " + format_fixed(detector.longest_m, 1) + " m, " +
            std::to_string(detector.filters.size()) + (detector.filters.size() == 1 ? " filter" : " filters") + " at " +
            format_fixed(detector.gsd_m, 3) + " m a pixel\n";
    text += "  on ground left out (" + std::to_string(quality.blocks) + " blocks): average precision " +
            format_fixed(quality.average_precision, 3) + "; recall " + measured_share_text(quality.recall) +
            "; precision " + measured_share_text(quality.precision) + "\n";
  }
  for (const std::string& one : training_assumptions()) text += "assumes: " + one + "\n";
  return text;
}

nlohmann::ordered_json result_json(const TrainedLandmarks& trained, const std::string& output) {
  nlohmann::ordered_json classes = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < trained.model.detectors.size(); ++i) {
    const auto& [detector, places, quality] = trained.model.detectors[i];
    classes.push_back({{"class", detector.class_name},
                       {"labels", places.size()},
                       {"shortest_m", detector.shortest_m},
                       {"longest_m", detector.longest_m},
                       {"filters", detector.filters.size()},
                       {"gsd_m", detector.gsd_m},
                       {"threshold", detector.threshold},
                       {"unobtainable", trained.unobtainable[i]},
                       {"blocks", quality.blocks},
                       {"average_precision", json_number(quality.average_precision)},
                       {"recall", share_to_json(quality.recall)},
                       {"precision", share_to_json(quality.precision)}});
  }
  return {{"output", output}, {"classes", classes}, {"assumptions", training_assumptions()}};
}

}  // namespace

Command make_landmark_train_command() {
  Command command;
  command.word = "landmark-train";
  command.group = CommandGroup::kLandmarks;
  command.summary = "Train detectors of labelled landmarks";
  command.examples = {{"A detector for each class of the chips.", "pilotage landmark-train chips -o landmarks.json"},
                      {"Chips of two dates of the same ground, learnt together.",
                       "pilotage landmark-train chips chips_last_year -o landmarks.json"}};
  command.inputs = {.name = "CHIPS", .help = "Folders that landmark-label wrote.", .min = 1, .max = InputSpec::kMany};
  command.output = {.kind = OutputKind::kFile, .help = "The detectors (JSON)."};
  bind_options<TrainOptions>(command, [](const TrainOptions& options, const Invocation& invocation) {
    OutputFile output(invocation.output, invocation.overwrite);
    const TrainedLandmarks trained =
        train_landmarks(invocation.inputs, options, invocation.threads, invocation.seed, invocation.progress);
    output.write(json_text(landmark_model_to_json(trained.model)));
    output.commit();
    CommandResult result;
    result.text = result_text(trained.model);
    result.json = result_json(trained, invocation.output);
    result.warnings = trained.warnings;
    return result;
  });
  return command;
}

}  // namespace pilotage
