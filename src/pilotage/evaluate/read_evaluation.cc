#include "pilotage/evaluate/read_evaluation.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include <nlohmann/json.hpp>

#include "pilotage/base/csv.h"
#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/options_json.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/evaluate/tile_outcome.h"

namespace pilotage {
namespace {

/// One cell after the other of a table by the names of its columns.
class NamedCells {
 public:
  NamedCells(const std::string& name, std::string_view text) : reader_(name, text) {
    std::vector<std::string> header;
    if (!reader_.next(header)) throw DataError(name + ": empty");
    for (std::size_t i = 0; i < header.size(); ++i) column_[header[i]] = i;
    columns_ = header.size();
    name_ = name;
  }

  bool next() {
    if (!reader_.next(cells_)) return false;
    if (cells_.size() != columns_) {
      throw DataError(reader_.where() + std::to_string(cells_.size()) + " cells, not " + std::to_string(columns_));
    }
    return true;
  }

  const std::string& text(const std::string& column) const {
    const auto found = column_.find(column);
    if (found == column_.end()) throw DataError(name_ + ": column \"" + column + "\" is missing");
    return cells_[found->second];
  }

  /// NaN where the cell is empty.
  double number(const std::string& column) const {
    const std::string& cell = text(column);
    if (cell.empty()) return std::numeric_limits<double>::quiet_NaN();
    const auto value = parse_number(cell);
    if (!value) throw DataError(reader_.where() + column + " = \"" + cell + "\" is no number");
    return *value;
  }

  std::string where() const { return reader_.where(); }

 private:
  CsvReader reader_;
  std::map<std::string, std::size_t> column_;
  std::size_t columns_ = 0;
  std::string name_;
  std::vector<std::string> cells_;
};

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
  const auto tile_size_px =
      static_cast<int>(std::lround(evaluation.positive_number("footprint_m") / evaluation.positive_number("gsd_m")));
  result.set.place = place;
  result.set.anchor = anchor;

  const std::string csv_name = (folder / "evaluation.csv").string();
  const std::string csv = read_file(csv_name);
  NamedCells row(csv_name, csv);
  while (row.next()) {
    const std::string& outcome = row.text("outcome");
    if (outcome == outcome_name(Outcome::kNotCovered)) continue;
    TileScores score;
    score.gray_variance = row.number("gray_variance");
    score.frieden_deficit = row.number("frieden_deficit");
    score.map_features = row.number("map_features");
    score.vote_noise = row.number("vote_noise");
    if (std::isnan(score.map_features) || std::isnan(score.frieden_deficit)) {
      throw DataError(row.where() + "no map_features or no frieden_deficit; score with the measure correct_fix");
    }
    result.set.samples.push_back(
        {matchability_inputs(score, tile_size_px), outcome == outcome_name(Outcome::kCorrect)});
  }
  return result;
}

}  // namespace pilotage
