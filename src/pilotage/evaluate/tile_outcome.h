#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "pilotage/flightlog/frame_match.h"

namespace pilotage {

/// Those that an evaluation counts: the truth is known of all.
inline constexpr Outcome kOutcomes[] = {Outcome::kCorrect, Outcome::kFalse, Outcome::kRefused, Outcome::kNotTried};

/// As evaluation.csv has it: "correct", "false", "refused", "not_covered".
std::string_view outcome_name(Outcome outcome);

/// What became of one tile, or of one real frame over it.
struct TileOutcome {
  std::size_t tile = 0;  ///< Index into the ground's tiles.
  Outcome outcome = Outcome::kNotTried;
  std::string status;  ///< The matcher's word: "fix", "ambiguous" …; "peak" for ncc.
  /// Of the best place, accepted or not, answer minus truth; NaN without one. For ncc along the grid's axes. At the
  /// centre of the image: whether the ground is recognised is the question here. Of a frame whose centre is not known,
  /// at the nadir.
  double error_m = std::numeric_limits<double>::quiet_NaN();
  double error_east_m = std::numeric_limits<double>::quiet_NaN();
  double error_north_m = std::numeric_limits<double>::quiet_NaN();
  double nadir_error_m = std::numeric_limits<double>::quiet_NaN();  ///< Of the aircraft's own place, likewise.
  double evidence = std::numeric_limits<double>::quiet_NaN();       ///< MatchStats::vote_peak; ncc: the correlation.
  std::string frame;                                                ///< Name of the real frame, "" for a rendered one.
};

/// Whether a place was accepted, right or not.
bool is_accepted(const TileOutcome& outcome);

/// Sets the errors of `best` against what is known of the truth.
void set_outcome_errors(TileOutcome& outcome, const Fix& best, const std::optional<GeodeticPoint>& true_center,
                        const std::optional<GeodeticPoint>& true_nadir);

}  // namespace pilotage
