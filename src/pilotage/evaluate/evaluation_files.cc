#include "pilotage/evaluate/evaluation_files.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "pilotage/base/csv.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/options_json.h"
#include "pilotage/base/statistics.h"
#include "pilotage/base/text.h"
#include "pilotage/ground/place_level.h"
#include "pilotage/matchability/reliability_diagram.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kNames[] = {"evaluation.md", "evaluation.json", "evaluation.csv", "reliability.svg"};

std::string counted_share_text(const Share& share) {
  if (share.of == 0) return "none";
  const Interval interval = share.interval();
  const auto percent = [](double value) { return format_fixed(100 * value, 1); };
  return std::to_string(share.count) + " of " + std::to_string(share.of) + ": " + percent(share.value()) + " % (" +
         percent(interval.low) + " … " + percent(interval.high) + ")";
}

std::string metres(double value) {
  return format_number(std::round(value * 100) / 100) + " m";
}

std::string matcher_text(const EvaluateOptions& options) {
  if (!options.frames.empty()) return "real frames, matched as in flight";
  if (options.matcher == EvaluateMatcher::kNcc) return "normalised correlation of the other date's tile";
  return "the matcher that flies, on a frame rendered from the other date over each tile";
}

/// Options that shape every outcome, in a sentence of Markdown.
std::string conditions(const Evaluation& evaluation, const EvaluateOptions& options) {
  std::string text = "Tiles of " + metres(evaluation.footprint_m) + ", " + metres(evaluation.gsd_m) +
                     "/px, searched within ± " + metres(evaluation.search_radius_m) + "; correct within " +
                     metres(evaluation.tolerance_m) + ".";
  if (options.matcher == EvaluateMatcher::kNcc) return text;
  text += std::string(" The map has ") + (options.chips ? "chips" : "no chips") + ".";
  if (!options.frames.empty()) return text;
  return text + " Standard deviations in the matcher's prior: " + format_number(options.attitude_sigma_deg) +
         "° of attitude, " + format_number(100 * options.height_sigma_fraction) + " % of height.";
}

/// Whether fixes come more or less often here than P expects, beside how far places lie apart.
std::string level_text(const Evaluation& evaluation) {
  const bool inside = std::abs(evaluation.level_z) <= kLevel80_z;
  return "level of this place: " + format_fixed(evaluation.level_z, 2) +
         " standard deviations from the mean that P expects, " + (inside ? "within" : "outside") +
         " the 80 % interval of " + format_fixed(kLevel80_z, 2);
}

/// Errors of the aircraft's own place where a place was accepted and they are known.
std::vector<double> nadir_errors_m(const Evaluation& evaluation) {
  std::vector<double> errors_m;
  for (const TileOutcome& outcome : evaluation.outcomes) {
    if (is_accepted(outcome) && !std::isnan(outcome.nadir_error_m)) errors_m.push_back(outcome.nadir_error_m);
  }
  return errors_m;
}

/// "" where none is known.
std::string nadir_text(const Evaluation& evaluation) {
  const std::vector<double> errors_m = nadir_errors_m(evaluation);
  if (errors_m.empty()) return "";
  return "the aircraft's own place, which tilt moves by the height: " + format_fixed(quantile(errors_m, 0.5), 2) +
         " m off in the median, " + format_fixed(quantile(errors_m, 0.95), 2) + " m at 95 %, of " +
         std::to_string(errors_m.size()) + " fixes; judged is the ground at the centre of the image";
}

const JudgedPredictor* probability_of(const Evaluation& evaluation) {
  const auto found = std::find_if(evaluation.predictors.begin(), evaluation.predictors.end(),
                                  [](const JudgedPredictor& predictor) { return predictor.quality.probability; });
  return found == evaluation.predictors.end() ? nullptr : &*found;
}

}  // namespace

Json evaluation_json(const Evaluation& evaluation, const EvaluationSource& source) {
  EvaluateOptions options = source.options;
  const std::int64_t correct = evaluation.counts.at(Outcome::kCorrect);
  const std::int64_t wrong = evaluation.counts.at(Outcome::kFalse);
  Json json;
  json["format"] = "pilotage-evaluation";
  json["format_version"] = 1;
  json["software_version"] = source.software_version;
  json["inputs"] = source.inputs;
  json["seed"] = source.seed;
  json["options"] = options_to_json(list_options(options));
  json["gsd_m"] = evaluation.gsd_m;
  json["footprint_m"] = evaluation.footprint_m;
  json["search_radius_m"] = evaluation.search_radius_m;
  json["tolerance_m"] = evaluation.tolerance_m;
  json["block_m"] = evaluation.block_m;
  json["scored_tiles"] = evaluation.scored_tiles;
  json["outcomes"] = Json::object();
  for (const Outcome outcome : kOutcomes) json["outcomes"][outcome_name(outcome)] = evaluation.counts.at(outcome);
  json["correct_fixes"] = share_to_json({correct, evaluation.judged()});
  json["false_fixes"] = share_to_json({wrong, correct + wrong});
  const std::vector<double> nadir_m = nadir_errors_m(evaluation);
  json["nadir_median_error_m"] = json_number(quantile(nadir_m, 0.5));
  json["nadir_p95_error_m"] = json_number(quantile(nadir_m, 0.95));
  json["false_like_neighbours"] = evaluation.false_like_neighbours;
  json["level_z"] = json_number(evaluation.level_z);
  json["predictors"] = Json::array();
  for (const JudgedPredictor& predictor : evaluation.predictors) json["predictors"].push_back(to_json(predictor));
  json["warnings"] = evaluation.warnings;
  return json;
}

std::string evaluation_markdown(const Evaluation& evaluation, const EvaluationSource& source, bool with_diagram) {
  const EvaluateOptions& options = source.options;
  const std::int64_t correct = evaluation.counts.at(Outcome::kCorrect);
  const std::int64_t wrong = evaluation.counts.at(Outcome::kFalse);
  std::string text = "# What the scores are worth\n\nScores of " + join(source.inputs, ", ") + ", held against " +
                     (options.file.empty() ? options.frames : options.file) + ": " + matcher_text(options) + ". " +
                     conditions(evaluation, options) + "\n\n";
  text += "- Correct fixes: " + counted_share_text({correct, evaluation.judged()}) + ".\n";
  text += "- False among accepted: " + counted_share_text({wrong, correct + wrong}) + ".\n";
  if (evaluation.false_like_neighbours > 0) {
    text += "- Of the false, " + std::to_string(evaluation.false_like_neighbours) +
            " lie off as the accepted fixes around them do: where that is many, rather the two georeferences disagree "
            "than the matcher errs. Register the other date first, or judge with a larger tolerance.\n";
  }
  if (const std::string nadir = nadir_text(evaluation); !nadir.empty()) text += "- Besides, " + nadir + ".\n";
  text += "- Refused: " + std::to_string(evaluation.counts.at(Outcome::kRefused)) +
          "; not covered and left out: " + std::to_string(evaluation.counts.at(Outcome::kNotTried)) +
          "; tiles scored: " + std::to_string(evaluation.scored_tiles) + ".\n\n";
  if (!std::isnan(evaluation.level_z)) text += "- " + level_text(evaluation) + ".\n\n";
  text += quality_markdown(evaluation.predictors, quality_options(options, source.seed));
  text += "- Blocks are squares of " + metres(evaluation.block_m) +
          ". Brackets at the rates above are 95 % intervals by "
          "Clopper and Pearson, as if tiles were independent.\n";
  if (with_diagram) text += "\n![Reliability diagram](reliability.svg)\n";
  return text + "\nSeed " + std::to_string(source.seed) + ". " + source.software_version + ".\n";
}

std::string evaluation_text(const Evaluation& evaluation) {
  const std::int64_t correct = evaluation.counts.at(Outcome::kCorrect);
  const std::int64_t wrong = evaluation.counts.at(Outcome::kFalse);
  std::string text = "evaluation: correct " + counted_share_text({correct, evaluation.judged()}) +
                     "; false among accepted " + counted_share_text({wrong, correct + wrong}) + "\n";
  if (const std::string nadir = nadir_text(evaluation); !nadir.empty()) text += "evaluation: " + nadir + "\n";
  for (const JudgedPredictor& predictor : evaluation.predictors) {
    const PredictionQuality& quality = predictor.quality;
    text += "evaluation: " + predictor.name + ": AUC " + estimate_text(quality.auc, 3);
    if (quality.probability) {
      text += "; Brier skill " + estimate_text(quality.brier_skill, 3) + "; calibration error " +
              estimate_text(quality.calibration_error, 3);
    }
    text += "\n";
  }
  if (!std::isnan(evaluation.level_z)) text += "evaluation: " + level_text(evaluation) + "\n";
  return text;
}

std::string evaluation_csv(const LevelScores& judged, const Evaluation& evaluation) {
  const std::vector<const Measure*> columns = columns_of_evaluation();
  std::string text =
      "tile_id,level,column,row,center_lon_deg,center_lat_deg,block,frame,outcome,status,error_m,error_east_m,error_"
      "north_m,nadir_error_m,evidence";
  for (const Measure* column : columns) text += "," + column->name;
  text += "\n";
  for (const TileOutcome& outcome : evaluation.outcomes) {
    const GroundTile& tile = judged.ground.tiles[outcome.tile];
    const std::int64_t block = block_of(judged, tile, evaluation.block_m / evaluation.gsd_m);
    std::vector<std::string> cells{std::to_string(tile.tile_id),
                                   std::to_string(tile.level),
                                   std::to_string(tile.column),
                                   std::to_string(tile.row),
                                   csv_cell(tile.center.lon_deg),
                                   csv_cell(tile.center.lat_deg),
                                   std::to_string(block),
                                   csv_cell(outcome.frame),
                                   std::string(outcome_name(outcome.outcome)),
                                   outcome.status,
                                   csv_cell(outcome.error_m),
                                   csv_cell(outcome.error_east_m),
                                   csv_cell(outcome.error_north_m),
                                   csv_cell(outcome.nadir_error_m),
                                   csv_cell(outcome.evidence)};
    for (const Measure* measure : columns) cells.push_back(csv_cell(measure->get(judged.scores[outcome.tile])));
    text += join(cells, ",") + "\n";
  }
  return text;
}

std::vector<std::filesystem::path> evaluation_outputs(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const char* name : kNames) files.push_back(folder / name);
  return files;
}

EvaluationFiles::EvaluationFiles(const std::filesystem::path& folder, bool overwrite)
    : folder_(folder), overwrite_(overwrite) {
  for (const char* name : kNames) OutputFile(folder / name, overwrite);
}

void EvaluationFiles::write(const LevelScores& judged, const Evaluation& evaluation, const EvaluationSource& source) {
  const JudgedPredictor* probability = probability_of(evaluation);
  const auto add = [&](const char* name, const std::string& content) {
    files_.push_back(std::make_unique<OutputFile>(folder_ / name, overwrite_));
    files_.back()->write(content);
  };
  add(kNames[0], evaluation_markdown(evaluation, source, probability != nullptr));
  add(kNames[1], json_text(evaluation_json(evaluation, source)));
  add(kNames[2], evaluation_csv(judged, evaluation));
  if (probability == nullptr) return;
  add(kNames[3], reliability_diagram_svg("P(correct fix), tiles of " + metres(evaluation.footprint_m),
                                         probability->quality, predictions_of(judged, evaluation, probability->name)));
}

std::vector<std::filesystem::path> EvaluationFiles::commit(const std::vector<const OutputFile*>& others) {
  std::vector<std::filesystem::path> written;
  std::vector<const OutputFile*> outputs;
  for (const auto& file : files_) {
    outputs.push_back(file.get());
    written.push_back(file->destination());
  }
  outputs.insert(outputs.end(), others.begin(), others.end());
  std::vector<std::filesystem::path> stale;
  if (written.size() < std::size(kNames)) stale.push_back(folder_ / kNames[3]);  // of an earlier run
  OutputFile::commit(outputs, stale);
  return written;
}

}  // namespace pilotage
