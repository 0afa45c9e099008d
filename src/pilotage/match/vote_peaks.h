#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "pilotage/match/checkpoint.h"
#include "pilotage/match/placement.h"

namespace pilotage {

/// What a pair of descriptors that look alike, one of the map and one of the frame, says for a displacement.
struct VotePair {
  Eigen::Vector2d from_pivot_px{0, 0};
  Eigen::Vector2d map_px{0, 0};
  std::int32_t weight = 0;  ///< In 1/kVoteUnit: whole numbers add up to the same in any order.
};

inline constexpr double kVoteUnit = 1 << 16;

/// The square of centres that pairs vote for, the turns and scales under which they do, and which peaks count.
struct VoteSearch {
  Eigen::Vector2d center_px{0, 0};
  double half_side_px = 0;
  std::vector<double> yaws_rad;  ///< Evenly spaced, as are the scales.
  std::vector<double> scales;
};

/// A place with many votes.
struct Candidate {
  Placement placement;
  double votes = 0;
};

/// The histogram of one turn and scale has bins of kVoteBinPx over the square, and is smoothed by a Gaussian of one
/// bin, five bins wide; outside the square there are no votes. A peak is a bin that none of the 5 × 5 around it exceeds
/// and that has at least kMinVotes. Of the peaks of all turns and scales the highest `count` are returned that are
/// kPeakSeparationPx apart, most votes first; of equal ones that of the first turn, scale, row, column.
///
/// By branch and bound (A. H. Land, A. G. Doig, Econometrica 28(3), 1960): for squares of bins and groups of
/// neighbouring turns and scales the votes of all pairs that can reach a square bound the peaks in it; only where they
/// come up to the `count`-th best is the histogram smoothed: in these squares, or as a whole where they are many. The
/// answer is that of all histograms, to the bit.
std::vector<Candidate> vote_peaks(const std::vector<VotePair>& pairs, const VoteSearch& search, std::size_t count,
                                  const Checkpoint& checkpoint = {});

inline constexpr double kVoteBinPx = 2;
inline constexpr double kPeakSeparationPx = 6;
inline constexpr double kMinVotes = 0.1;

}  // namespace pilotage
