#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "pilotage/evaluate/evaluation_files.h"
#include "pilotage/replay/replay.h"

namespace pilotage {

/// evaluation.json and evaluation.csv of a replay, as `pilotage calibrate` takes them: one line for each pass over a
/// stored tile with a P, with the outcome of the frame nearest to the tile's centre. A fix without truth counts as
/// correct, with a warning. `chips`: the map had chips and the matcher used them.
struct CalibrationFiles {
  std::string json;
  std::string csv;
};
CalibrationFiles calibration_files(const Replay& replay, bool chips, const EvaluationSource& source);

}  // namespace pilotage
