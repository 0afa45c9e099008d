#include "pilotage/report/evaluation_note.h"

#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
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
  const fs::path diagram = file.parent_path() / "reliability.svg";
  if (probability && fs::exists(diagram)) note.diagram_svg = read_file(diagram, std::uintmax_t{1} << 20);
  return note;
}

}  // namespace pilotage
