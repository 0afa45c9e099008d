#include "pilotage/report/evaluation_note.h"

#include <algorithm>
#include <optional>
#include <set>

#include <nlohmann/json.hpp>

#include "pilotage/base/csv.h"
#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/options_json.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/base/utf8.h"
#include "pilotage/matchability/quality_report.h"

namespace pilotage {
namespace {

namespace fs = std::filesystem;

std::string estimate_of(JsonObject& predictor, const std::string& key) {
  JsonObject json = predictor.object(key);
  Estimate estimate;
  estimate.value = json.number_or_nan("value");
  estimate.interval = {json.number_or_nan("low"), json.number_or_nan("high")};
  return estimate_text(estimate, 3);
}

std::vector<EvaluationNote::Found> read_found(const fs::path& file) {
  const std::string text = read_file(file);
  CsvTable table(file.string(), text, "a table of outcomes (evaluation.csv)");
  const auto index_of = [&](const std::string& name) {
    const auto at = std::find(table.columns().begin(), table.columns().end(), name);
    if (at == table.columns().end()) throw DataError(file.string() + ": has no column " + name);
    return static_cast<std::size_t>(at - table.columns().begin());
  };
  const std::size_t tile_id = index_of("tile_id");
  const std::size_t lon = index_of("center_lon_deg");
  const std::size_t lat = index_of("center_lat_deg");
  const std::size_t outcome = index_of("outcome");
  const std::size_t error = index_of("error_m");
  std::vector<EvaluationNote::Found> found;
  while (const std::vector<std::string>* row = table.next()) {
    const auto number = [&](std::size_t column) {
      const std::optional<double> value = parse_number((*row)[column]);
      if (!value) throw DataError(table.where() + "\"" + (*row)[column].substr(0, 40) + "\" is no number");
      return *value;
    };
    static const std::set<std::string> kOutcomes = {"correct", "false", "refused", "not_covered"};
    if (!kOutcomes.contains((*row)[outcome])) {
      throw DataError(table.where() + "\"" + (*row)[outcome].substr(0, 40) + "\" is no outcome");
    }
    found.push_back({static_cast<std::int64_t>(number(tile_id)),
                     {number(lon), number(lat)},
                     (*row)[outcome],
                     (*row)[error].empty() ? kNaN : number(error)});
  }
  return found;
}

}  // namespace

EvaluationNote read_evaluation_note(const fs::path& path) {
  const fs::path file = fs::is_directory(path) ? path / "evaluation.json" : path;
  const nlohmann::ordered_json json = parse_json(file.string(), read_file(file));
  JsonObject object(json, file.string());
  if (!object.has("format") || object.text("format") != "pilotage-evaluation") {
    throw DataError(file.string() + ": is not an evaluation (pilotage score --evaluate writes evaluation.json)");
  }
  EvaluationNote note;
  note.file = file.string();
  note.source = valid_utf8(join(object.texts("inputs"), ", "));
  JsonObject outcomes = object.object("outcomes");
  note.outcomes = std::to_string(outcomes.integer("correct", 0)) + " correct, " +
                  std::to_string(outcomes.integer("false", 0)) + " false, " +
                  std::to_string(outcomes.integer("refused", 0)) + " refused, " +
                  std::to_string(outcomes.integer("not_covered", 0)) + " not covered";
  bool probability = false;
  for (JsonObject& predictor : object.objects("predictors")) {
    EvaluationNote::Row row;
    row.title = valid_utf8(predictor.text("title"));
    row.auc = estimate_of(predictor, "auc");
    if (predictor.boolean("probability")) {
      probability = true;
      row.brier_skill = estimate_of(predictor, "brier_skill");
      row.calibration_error = estimate_of(predictor, "calibration_error");
    }
    note.rows.push_back(row);
  }
  const fs::path table = file.parent_path() / "evaluation.csv";
  if (fs::exists(table)) note.found = read_found(table);
  const fs::path diagram = file.parent_path() / "reliability.svg";
  if (probability && fs::exists(diagram)) note.diagram_svg = read_file(diagram, std::uintmax_t{1} << 20);
  return note;
}

}  // namespace pilotage
