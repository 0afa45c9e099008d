#pragma once

#include <filesystem>
#include <string>

#include "pilotage/matchability/fit_model.h"

namespace pilotage {

/// An evaluation as a model is fitted on it.
struct EvaluatedSet {
  FlyingMatcher matcher = FlyingMatcher::kFeatures;
  FitSet set;
};

/// Reads evaluation.json and evaluation.csv of a folder that `score --evaluate` wrote: the tiles that were covered,
/// each with its inputs and whether its fix was correct. Throws DataError, naming the file, when one cannot be read,
/// when the scores lack P's inputs (score with the measure correct_fix), or when the matcher was not the voting one.
EvaluatedSet read_evaluated_set(const std::filesystem::path& folder, const std::string& place, bool anchor);

}  // namespace pilotage
