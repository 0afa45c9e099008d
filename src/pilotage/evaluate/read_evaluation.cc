#include "pilotage/evaluate/read_evaluation.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <nlohmann/json.hpp>

#include "pilotage/base/csv.h"
#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/options_json.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/evaluate/tile_outcome.h"

namespace pilotage {
namespace {

/// A cell of the last row by the name of its column.
const std::string& cell_of(const CsvTable& table, const std::vector<std::string>& cells, const std::string& column) {
  const auto found = std::find(table.columns().begin(), table.columns().end(), column);
  if (found == table.columns().end()) throw DataError(table.where() + "column \"" + column + "\" is missing");
  return cells[static_cast<std::size_t>(found - table.columns().begin())];
}

/// NaN where the cell is empty.
double number_of(const CsvTable& table, const std::vector<std::string>& cells, const std::string& column) {
  const std::string& cell = cell_of(table, cells, column);
  if (cell.empty()) return kNaN;
  if (const auto value = parse_number(cell)) return *value;
  throw DataError(table.where() + column + " = \"" + cell.substr(0, 40) + "\" is no number");
}

}  // namespace

EvaluatedSet read_evaluated_set(const std::filesystem::path& folder, const std::string& place, bool anchor) {
  const std::string json_name = (folder / "evaluation.json").string();
  const nlohmann::ordered_json json = parse_json(json_name, read_file(json_name));
  JsonObject evaluation(json, json_name);
  JsonObject options = evaluation.object("options");
  if (options.text("matcher") != "voting") {
    throw DataError(json_name + ": the matcher was not \"voting\"; P(correct fix) is that of the matcher that flies");
  }
  EvaluatedSet result;
  if (options.boolean("chips")) result.matcher = FlyingMatcher::kFeaturesAndChips;
  result.set.place = place;
  result.set.anchor = anchor;

  const std::string csv_name = (folder / "evaluation.csv").string();
  const std::string csv = read_file(csv_name);
  CsvTable table(csv_name, csv, "a table of evaluated tiles");
  while (const auto* cells = table.next()) {
    const std::string& outcome = cell_of(table, *cells, "outcome");
    if (outcome == outcome_name(Outcome::kNotTried)) continue;
    TileScores score;
    score.frieden_deficit = number_of(table, *cells, "frieden_deficit");
    score.map_features = number_of(table, *cells, "map_features");
    score.vote_noise = number_of(table, *cells, "vote_noise");
    score.fine_contrast = number_of(table, *cells, "fine_contrast");
    if (std::isnan(score.map_features) || std::isnan(score.frieden_deficit)) {
      throw DataError(table.where() + "no map_features or no frieden_deficit; score with the measure correct_fix");
    }
    result.set.samples.push_back({matchability_inputs(score), outcome == outcome_name(Outcome::kCorrect)});
  }
  return result;
}

}  // namespace pilotage
