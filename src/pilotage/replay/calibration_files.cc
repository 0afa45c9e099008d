#include "pilotage/replay/calibration_files.h"

#include <nlohmann/json.hpp>

#include "pilotage/base/csv.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

Outcome outcome_of_pass(const TilePass& pass) {
  switch (pass.outcome) {
    case FrameOutcome::kRight:
    case FrameOutcome::kUnjudged:
      return Outcome::kCorrect;
    case FrameOutcome::kFalse:
      return Outcome::kFalse;
    default:
      return Outcome::kRefused;
  }
}

std::string row_of_pass(const TilePass& pass) {
  const MapTile& tile = pass.tile.tile;
  const TileScores& scores = pass.tile.scores;
  const std::vector<std::string> cells{std::to_string(tile.tile_id),
                                       std::to_string(tile.level),
                                       std::to_string(tile.column),
                                       std::to_string(tile.row),
                                       csv_cell(tile.center.lon_deg),
                                       csv_cell(tile.center.lat_deg),
                                       std::to_string(pass.block),
                                       csv_cell(pass.file),
                                       std::string(outcome_name(outcome_of_pass(pass))),
                                       csv_cell(pass.status),
                                       csv_cell(pass.error_m),
                                       "",
                                       "",
                                       "",
                                       csv_cell(scores.p_correct_fix),
                                       csv_cell(scores.gray_variance),
                                       csv_cell(scores.frieden_deficit),
                                       "",
                                       "",
                                       csv_cell(scores.map_features),
                                       csv_cell(scores.vote_noise),
                                       csv_cell(scores.relative_contrast)};
  return join(cells, ",") + "\n";
}

}  // namespace

CalibrationFiles calibration_files(const Replay& replay, bool chips, const EvaluationSource& source) {
  CalibrationFiles files;
  files.csv =
      "tile_id,level,column,row,center_lon_deg,center_lat_deg,block,frame,outcome,status,error_m,error_east_m,error_"
      "north_m,evidence,p_correct_fix,gray_variance,frieden_deficit,clean_peak_margin,degraded_peak_margin,map_"
      "features,vote_noise,relative_contrast\n";
  Evaluation evaluation;
  evaluation.tolerance_m = replay.correct_within_m;
  for (const Outcome outcome : kOutcomes) evaluation.counts[outcome] = 0;
  bool unjudged = false;
  for (const TilePass& pass : replay.passes) {
    ++evaluation.counts[outcome_of_pass(pass)];
    unjudged = unjudged || pass.outcome == FrameOutcome::kUnjudged;
    TileOutcome outcome;
    outcome.outcome = outcome_of_pass(pass);
    evaluation.outcomes.push_back(std::move(outcome));
    files.csv += row_of_pass(pass);
  }
  evaluation.scored_tiles = replay.contradictions.tiles;
  if (replay.prediction) {
    evaluation.predictors.push_back({"p_correct_fix", "P(correct fix)", replay.prediction->quality});
  }
  if (unjudged) evaluation.warnings.emplace_back("fixes whose truth is not known count as correct");
  EvaluationSource of_replay = source;
  of_replay.options.frames = join(replay.flights, " ");
  of_replay.options.chips = chips;
  files.json = json_text(evaluation_json(evaluation, of_replay));
  return files;
}

}  // namespace pilotage
