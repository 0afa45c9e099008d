#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pilotage/match/match.h"
#include "pilotage/mission/frame_table.h"

namespace pilotage {

/// How far an answer lies from the truth.
struct FixError {
  double east_m = 0;  ///< Answer minus truth.
  double north_m = 0;
  double error_m = 0;
  /// Normalised error squared eᵀ·C⁻¹·e with the covariance of the answer: χ² of 2 degrees of freedom when it is honest;
  /// NaN when C cannot be inverted.
  double nees = 0;
};

/// What became of a frame that was tried: rendered, of a log, or real.
enum class Outcome {
  kCorrect,   ///< A fix within the limit of the truth.
  kFalse,     ///< A fix farther off.
  kUnjudged,  ///< A fix whose truth is not known.
  kRefused,   ///< The matcher gave no fix.
  kNotTried,  ///< Nothing to match, or nothing to judge by: no picture, no prior, too little imagery, no scored tile.
};

/// Of a fix that is `error_m` away from the truth, NaN where that is not known.
Outcome outcome_of_fix(double error_m, double correct_within_m);

/// A frame from a file and what became of it.
struct FrameMatch {
  FrameRecord frame;  ///< With the prior that was matched with.
  /// Why there is nothing to match, "" otherwise: the file cannot be read as a picture, or has not the camera's shape.
  std::string problem;
  MatchResult result;                                              ///< Meaningless when there is a problem.
  double milliseconds = std::numeric_limits<double>::quiet_NaN();  ///< Of match() alone: reading the file is not in it.
  bool confirmed = false;                   ///< A fix because it lies where the frames before say (match_sequence.h).
  std::optional<FixError> error;            ///< Of result.fix against FrameRecord::truth(), where both are known.
  std::optional<FixError> center_error;     ///< Of its centre, where that is known.
  std::optional<FixError> candidate_error;  ///< Of result.candidate against FrameRecord::truth().
  std::optional<FixError> candidate_center_error;

  bool readable() const { return problem.empty(); }
  bool has_fix() const { return readable() && result.fix.has_value(); }
};

/// "fix", another match_status_name(), or "unreadable" when there is a problem.
std::string frame_status_name(const FrameMatch& match);
/// A sentence about it.
std::string frame_status_text(const FrameMatch& match);

/// match_status_name() of each.
std::vector<std::string> match_status_names(std::span<const MatchStatus> statuses);

/// `fix` against a true point: its position for FrameTruth::kNadir, its centre for kCenter.
FixError error_of_fix(const Fix& fix, GeodeticPoint truth, FrameTruth kind);

/// Sets the errors of what `match` holds, where the truth is known.
void set_errors(FrameMatch& match);

/// Reads the picture `path` (anything GDAL opens; gray as the maps' imagery is made gray), and matches it. What cannot
/// be read is a FrameMatch with a problem. Throws nothing but std::bad_alloc and, when `go_on` returns false,
/// Interrupted.
FrameMatch match_frame(const std::string& path, const FrameRecord& frame, const Camera& camera,
                       std::span<MapReader> maps, const MatchOptions& options, const std::function<bool()>& go_on = {});

/// For who counts answers: map_unreadable and out_of_memory tell of a disk or a machine and nothing of the frame, and
/// counted as refusals they would make a rate that is wrong, also where another map answers. Throws DataError beginning
/// with the name of that of the `maps`, which were asked in this order, or std::bad_alloc.
void require_frame_was_tried(const MatchResult& result, std::span<const std::string> maps);

}  // namespace pilotage
