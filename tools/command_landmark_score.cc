#include <cmath>
#include <optional>

#include "commands.h"

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/landmark/landmark_files.h"
#include "pilotage/landmark/score_landmarks.h"
#include "pilotage/mission/landmark_file.h"

namespace pilotage {
namespace {

std::vector<std::string> score_assumptions() {
  return {"everything of these classes that the imagery shows is labelled: what is not counts as a false alarm",
          "labels lie where the imagery shows them: how far the two dates are apart is part of the position errors "
          "(`pilotage audit` measures it)",
          "the threshold is the model's; ground whose chips were learnt as background has fewer false alarms than "
          "other ground"};
}

std::string class_text(const ScoredClass& scored, double search_radius_m) {
  std::string text = scored.class_name + ": recall " + measured_share_text(scored.recall) + "\n";
  if (scored.recall_elsewhere.of > 0 && scored.recall_elsewhere.of < scored.recall.of) {
    text += "  of those that the detector did not learn: " + measured_share_text(scored.recall_elsewhere) + "\n";
  } else if (scored.recall_elsewhere.of == 0) {
    text += "  the detector learnt all of these landmarks: of other places this says nothing\n";
  }
  const Interval rate = scored.false_alarms.interval();
  text += "  false alarms: " + format_fixed(scored.false_alarms.value(), 2) + " for each km² (" +
          std::to_string(scored.false_alarms.count) + " on " + format_fixed(scored.false_alarms.area_km2, 2) +
          " km²; 95 % interval " + format_fixed(rate.low, 2) + " to " + format_fixed(rate.high, 2) +
          "); average precision " + format_fixed(scored.average_precision, 3) + "\n";
  if (scored.recall.count > 0) {
    text += "  position: " + format_fixed(scored.error_median_m, 2) + " m median, " +
            format_fixed(scored.error_95_m, 2) + " m 95 %; " + format_fixed(scored.sigma_m, 2) +
            " m each axis (95 % interval " + format_fixed(scored.sigma_interval_m.low, 2) + " to " +
            format_fixed(scored.sigma_interval_m.high, 2) + ")\n";
  }
  return text + "  ambiguity: " + format_fixed(scored.median_ambiguity, 2) + " others within " +
         format_number(search_radius_m) + " m (median)\n";
}

nlohmann::ordered_json class_json(const ScoredClass& scored) {
  const Interval rate = scored.false_alarms.interval();
  return {
      {"class", scored.class_name},
      {"recall", share_to_json(scored.recall)},
      {"recall_elsewhere", share_to_json(scored.recall_elsewhere)},
      {"average_precision", json_number(scored.average_precision)},
      {"false_alarms",
       {{"count", scored.false_alarms.count},
        {"area_km2", scored.false_alarms.area_km2},
        {"per_km2", json_number(scored.false_alarms.value())},
        {"low", json_number(rate.low)},
        {"high", json_number(rate.high)}}},
      {"error_m", {{"median", json_number(scored.error_median_m)}, {"quantile_95", json_number(scored.error_95_m)}}},
      {"sigma_m",
       {{"value", json_number(scored.sigma_m)},
        {"low", json_number(scored.sigma_interval_m.low)},
        {"high", json_number(scored.sigma_interval_m.high)}}},
      {"median_ambiguity", json_number(scored.median_ambiguity)}};
}

CommandResult run_score(const LandmarkScoreOptions& options, const Invocation& invocation) {
  if (!invocation.output.empty()) check_scored_landmarks_name(invocation.output);
  std::optional<OutputFile> for_map;
  if (!options.for_map.empty()) for_map.emplace(options.for_map, invocation.overwrite);
  const LandmarkModel model = read_landmark_model(invocation.inputs.front());
  const LandmarkScores scores = score_landmarks(model, options, invocation.threads, invocation.progress);
  const MapLandmarks landmarks = landmarks_for_map(model, scores);
  if (for_map) {
    if (landmarks.detectors.empty()) {
      throw DataError(options.for_map + ": no detector finds a landmark: there is nothing for a map");
    }
    for_map->write(json_text(map_landmarks_to_json(landmarks), 0));
  }
  if (!invocation.output.empty()) write_scored_landmarks(invocation.output, scores, invocation.overwrite);
  if (for_map) for_map->commit();
  CommandResult result;
  result.json = {{"second_epoch", options.second_epoch},
                 {"acquired", scores.acquired},
                 {"search_radius_m", options.search_radius_m},
                 {"outside", scores.outside},
                 {"other_date", scores.other_date},
                 {"classes", nlohmann::ordered_json::array()},
                 {"assumptions", score_assumptions()}};
  for (const ScoredClass& scored : scores.classes) {
    result.text += class_text(scored, options.search_radius_m);
    result.json["classes"].push_back(class_json(scored));
  }
  if (for_map) {
    result.json["for_map"] = options.for_map;
    result.text += "for a map: " + std::to_string(landmarks.landmarks.size()) + " landmarks of " +
                   std::to_string(landmarks.detectors.size()) +
                   (landmarks.detectors.size() == 1 ? " class in " : " classes in ") + options.for_map + "\n";
  }
  if (scores.outside > 0) result.text += std::to_string(scores.outside) + " labels are not shown: left out\n";
  if (scores.other_date > 0) {
    result.text += std::to_string(scores.other_date) + " labels are of another date: left out\n";
  }
  for (const std::string& one : score_assumptions()) result.text += "assumes: " + one + "\n";
  result.warnings = scores.warnings;
  return result;
}

}  // namespace

Command make_landmark_score_command() {
  Command command;
  command.word = "landmark-score";
  command.group = CommandGroup::kLandmarks;
  command.summary = "Look for landmarks on imagery of another date";
  command.examples = {
      {"What the detectors find on last year's imagery, and where.",
       "pilotage landmark-score landmarks.json --labels chips/labels.geojson --second-epoch last_year.tif -o "
       "found.geojson"},
      {"For an onboard map.",
       "pilotage landmark-score landmarks.json --labels chips/labels.geojson --second-epoch last_year.tif --for-map "
       "map_landmarks.json"}};
  command.inputs = {.name = "MODEL", .help = "The detectors that landmark-train wrote.", .min = 1, .max = 1};
  command.output = {.kind = OutputKind::kFile,
                    .help = "Every landmark, found or missed, and every false alarm as points (.geojson or .gpkg).",
                    .required = false};
  command.reads_rasters = true;
  bind_options<LandmarkScoreOptions>(command, run_score);
  return command;
}

}  // namespace pilotage
