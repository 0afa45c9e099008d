#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pilotage/geo/geodetic_point.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// What an evaluation (`pilotage score --evaluate`) says of scores, for the page.
struct EvaluationNote {
  struct Row {
    std::string title;              ///< Of the predictor: "P(correct fix)".
    std::string auc;                ///< "0.812 (0.751 … 0.863)"; "–" where it is not defined. So the next two.
    std::string brier_skill;        ///< "" when the predictor is no probability.
    std::string calibration_error;  ///< Likewise.
  };
  /// What was found at a tile, or of a real frame that belongs to it.
  struct Found {
    std::int64_t tile_id = 0;
    GeodeticPoint center;  ///< Of the tile: another grid has other ground under the same number.
    std::string outcome;   ///< "correct", "false", "refused" or "not_covered".
    double error_m = 0;    ///< Of the best place; NaN where nothing was matched.
  };
  std::string file;          ///< That was read.
  std::string source;        ///< What was judged: the inputs, joined.
  std::string outcomes;      ///< "412 correct, 3 false, 96 refused, 11 not covered".
  std::vector<Row> rows;     ///< In the order of the file.
  std::string diagram_svg;   ///< The reliability diagram; "" without a probability.
  std::vector<Found> found;  ///< In the order of evaluation.csv; empty without that file.
};

/// Reads evaluation.json (or the folder that holds it) and the reliability.svg and evaluation.csv beside it, when there
/// are any. Throws DataError when a file cannot be read or is not of an evaluation.
EvaluationNote read_evaluation_note(const std::filesystem::path& path);

}  // namespace pilotage

#pragma GCC visibility pop
