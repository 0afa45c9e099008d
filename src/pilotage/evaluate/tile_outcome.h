#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <string_view>

namespace pilotage {

enum class Outcome {
  kCorrect,     ///< Accepted, and within the tolerance.
  kFalse,       ///< Accepted, and farther off.
  kRefused,     ///< No place was accepted.
  kNotCovered,  ///< Nothing to judge: the other date shows too little of it, or the frame shows no scored tile.
};

inline constexpr Outcome kOutcomes[] = {Outcome::kCorrect, Outcome::kFalse, Outcome::kRefused, Outcome::kNotCovered};

std::string_view outcome_name(Outcome outcome);  ///< "correct", "false", "refused", "not_covered".

/// What became of one tile, or of one real frame over it.
struct TileOutcome {
  std::size_t tile = 0;  ///< Index into the ground's tiles.
  Outcome outcome = Outcome::kNotCovered;
  std::string status;  ///< The matcher's word: "fix", "ambiguous" …; "peak" for ncc.
  /// Of the best place, accepted or not, answer minus truth; NaN without one. For ncc along the grid's axes.
  double error_m = std::numeric_limits<double>::quiet_NaN();
  double error_east_m = std::numeric_limits<double>::quiet_NaN();
  double error_north_m = std::numeric_limits<double>::quiet_NaN();
  double evidence = std::numeric_limits<double>::quiet_NaN();  ///< MatchStats::vote_peak; ncc: the correlation.
  std::string frame;                                           ///< Name of the real frame, "" for a rendered one.
};

}  // namespace pilotage
