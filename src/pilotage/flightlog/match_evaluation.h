#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/base/statistics.h"
#include "pilotage/flightlog/fix_lean.h"
#include "pilotage/flightlog/frame_match.h"
#include "pilotage/flightlog/match_sequence.h"

namespace pilotage {

/// The mean of N normalised errors squared, each χ² of 2 degrees of freedom: 2 when the covariances are honest. The sum
/// is χ² of 2N degrees; `band` holds the mean of honest covariances with probability 95 %.
struct NeesSummary {
  std::int64_t count = 0;
  double mean = 0;  ///< NaN when `count` is 0, as is `band`.
  Interval band;
  bool inside() const { return mean >= band.low && mean <= band.high; }
};

/// What a flight says of the matcher.
struct MatchEvaluation {
  std::int64_t frames = 0;
  std::int64_t unreadable = 0;
  std::int64_t accepted = 0;                    ///< Frames with a fix.
  std::vector<std::int64_t> fixes_by_map;       ///< Of these, the answers of each map that was asked.
  std::map<std::string, std::int64_t> refused;  ///< Frames without one, by frame_status_name().
  std::optional<SequenceSummary> sequence;      ///< Of frames that were matched in sequence.
  FixLean lean;                                 ///< How all fixes lie together.

  // Of the frames whose truth is known, judged by FrameRecord::truth().
  double correct_within_m = 0;
  std::int64_t frames_with_truth = 0;
  Share correct;              ///< Fixes with error ≤ correct_within_m, of all frames (unreadable ones too).
  Share false_fixes;          ///< Fixes with a larger error, of the accepted ones.
  double median_error_m = 0;  ///< Of the accepted; NaN without one.
  double p95_error_m = 0;
  NeesSummary nees;                   ///< Of the accepted.
  NeesSummary nees_correct;           ///< Of the correct ones: what a few false fixes cannot spoil.
  std::int64_t judged_at_center = 0;  ///< Frames with truth whose own place is not known, but that of their centre.

  /// What the fixes' centres are worth, where both points are known: a tilt that is wrong moves the aircraft's place by
  /// the height for each radian, and hardly the centre's.
  struct Centers {
    std::int64_t fixes = 0;
    std::int64_t within = 0;  ///< correct_within_m.
    double median_error_m = 0;
    double p95_error_m = 0;
    NeesSummary nees;
  };
  std::optional<Centers> centers;

  double median_ms = 0;  ///< Time of match(), of the frames that could be read; NaN when not measured.
  double p95_ms = 0;
};

/// `options`: what the frames were matched with. Throws UsageError unless correct_within_m is above 0.
MatchEvaluation evaluate_matches(std::span<const FrameMatch> matches, double correct_within_m,
                                 const MatchOptions& options = {});

/// Keys as the fields are named, NaN as null; what needs truth is left out when there is none, times when they are not
/// wanted.
nlohmann::ordered_json to_json(const MatchEvaluation& evaluation, bool timings = true);

/// The same for people, one line per thing.
std::string evaluation_text(const MatchEvaluation& evaluation, bool timings = true);

}  // namespace pilotage
