#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

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
  std::string file;         ///< That was read.
  std::string source;       ///< What was judged: the inputs, joined.
  std::string outcomes;     ///< "412 correct, 3 false, 96 refused, 11 not covered".
  std::vector<Row> rows;    ///< In the order of the file.
  std::string diagram_svg;  ///< The reliability diagram; "" without a probability.
};

/// Reads evaluation.json (or the folder that holds it) and the reliability.svg beside it, when there is one. Throws
/// DataError when the file cannot be read or is not an evaluation.
EvaluationNote read_evaluation_note(const std::filesystem::path& path);

}  // namespace pilotage

#pragma GCC visibility pop
