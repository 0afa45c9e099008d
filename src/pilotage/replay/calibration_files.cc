#include "pilotage/replay/calibration_files.h"

#include <nlohmann/json.hpp>

#include "pilotage/base/csv.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/text.h"
#include "pilotage/ground/measures.h"

namespace pilotage {
namespace {

/// A fix that nobody can judge counts as correct: false ones are one in a thousand.
Outcome outcome_of_pass(const TilePass& pass) {
  return pass.outcome == Outcome::kUnjudged ? Outcome::kCorrect : pass.outcome;
}

std::string row_of_pass(const TilePass& pass, const std::vector<const Measure*>& columns) {
  const MapTile& tile = pass.tile.tile;
  std::vector<std::string> cells{std::to_string(tile.tile_id),
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
                                 ""};
  for (const Measure* measure : columns) cells.push_back(csv_cell(measure->get(pass.tile.scores)));
  return join(cells, ",") + "\n";
}

}  // namespace

CalibrationFiles calibration_files(const Replay& replay, bool chips, const EvaluationSource& source) {
  CalibrationFiles files;
  const std::vector<const Measure*> columns = columns_of_evaluation();
  files.csv =
      "tile_id,level,column,row,center_lon_deg,center_lat_deg,block,frame,outcome,status,error_m,error_east_m,error_"
      "north_m,evidence";
  for (const Measure* measure : columns) files.csv += "," + measure->name;
  files.csv += "\n";
  Evaluation evaluation;
  evaluation.tolerance_m = replay.correct_within_m;
  for (const Outcome outcome : kOutcomes) evaluation.counts[outcome] = 0;
  bool unjudged = false;
  for (const TilePass& pass : replay.passes) {
    ++evaluation.counts[outcome_of_pass(pass)];
    unjudged = unjudged || pass.outcome == Outcome::kUnjudged;
    TileOutcome outcome;
    outcome.outcome = outcome_of_pass(pass);
    evaluation.outcomes.push_back(std::move(outcome));
    files.csv += row_of_pass(pass, columns);
  }
  evaluation.scored_tiles = replay.contradictions.tiles;
  if (replay.prediction) {
    evaluation.predictors.push_back({predictor_columns().front(), "P(correct fix)", replay.prediction->quality});
  }
  if (unjudged) evaluation.warnings.emplace_back("fixes whose truth is not known count as correct");
  EvaluationSource of_replay = source;
  of_replay.options.frames = join(replay.flights, " ");
  of_replay.options.chips = chips;
  files.json = json_text(evaluation_json(evaluation, of_replay));
  return files;
}

}  // namespace pilotage
