#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/base/output_file.h"
#include "pilotage/evaluate/evaluation.h"

namespace pilotage {

/// Where an evaluation comes from, for its files.
struct EvaluationSource {
  std::vector<std::string> inputs;  ///< As given: rasters, or the plan.
  std::string software_version;
  EvaluateOptions options;
  std::uint64_t seed = 1;
};

/// schemas/evaluation.schema.json.
nlohmann::ordered_json evaluation_json(const Evaluation& evaluation, const EvaluationSource& source);

/// A page for people: what was judged and how, the table of predictors, what the numbers mean.
std::string evaluation_markdown(const Evaluation& evaluation, const EvaluationSource& source, bool with_diagram);

/// The same in short: outcomes and the AUC of each predictor, one line each.
std::string evaluation_text(const Evaluation& evaluation);

/// evaluation.csv (schemas/evaluation-csv.md): one line for each outcome.
std::string evaluation_csv(const LevelScores& judged, const Evaluation& evaluation);

/// The files that an evaluation may write in a folder.
std::vector<std::filesystem::path> evaluation_outputs(const std::filesystem::path& folder);

/// The four files evaluation.md, .json, .csv and reliability.svg of a folder, refused before the work is done when one
/// exists, and appearing together after it.
class EvaluationFiles {
 public:
  /// Throws DataError when a file exists and `overwrite` is false.
  EvaluationFiles(const std::filesystem::path& folder, bool overwrite);

  /// Writes all; reliability.svg only when there is a probability. Throws DataError.
  void write(const LevelScores& judged, const Evaluation& evaluation, const EvaluationSource& source);
  /// Lets them appear together with `others`, outputs of the same run, and says which they are without those. Throws
  /// DataError.
  std::vector<std::filesystem::path> commit(const std::vector<const OutputFile*>& others = {});

 private:
  std::filesystem::path folder_;
  bool overwrite_;
  std::vector<std::unique_ptr<OutputFile>> files_;
};

}  // namespace pilotage
