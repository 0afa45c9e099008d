#pragma once

#include <span>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/matchability/prediction_quality.h"

namespace pilotage {

/// A predictor and what it is worth: one row of an evaluation.
struct JudgedPredictor {
  std::string name;   ///< A column of tiles.csv: "p_correct_fix", "gray_variance" …
  std::string title;  ///< For people: "P(correct fix)".
  PredictionQuality quality;
};

/// "0.812 (0.751 … 0.863)"; without an interval the number alone, "–" when it is not defined.
std::string estimate_text(const Estimate& estimate, int digits);

/// Keys as the fields of PredictionQuality, numbers with interval as {value, low, high}; NaN as null; what is for
/// probabilities only is left out of other predictors. `$defs/predictor` of schemas/evaluation.schema.json.
nlohmann::ordered_json to_json(const JudgedPredictor& predictor);

/// A table for people, one row for each predictor, and below it what the numbers mean and how far to trust them: which
/// predictors point the wrong way (the whole interval of AUC below 0.5), and how few blocks there are. Markdown.
std::string quality_markdown(std::span<const JudgedPredictor> predictors, const QualityOptions& options);

}  // namespace pilotage
