#pragma once

#include <cstdint>
#include <vector>

#include "pilotage/ground/tile_scores.h"
#include "pilotage/mission/mission.h"
#include "pilotage/mission/stored_size.h"
#include "pilotage/select/fix_attempts.h"
#include "pilotage/select/route_probability.h"

namespace pilotage {

/// The tiles of `wanted` that fit, in this order while they do: those of `first`; the sparse areas, nearest to the
/// route first; the others by whole half strides from the route, and by margin among equals. Throws UsageError for a
/// budget that cannot hold an empty map.
std::vector<bool> tiles_in_order(const Mission& mission, const std::vector<TileScores>& scores,
                                 const std::vector<bool>& wanted, const std::vector<bool>& sparse,
                                 const std::vector<bool>& first, const StoredSize& size, std::int64_t budget);

/// What a selection under a budget is judged by: P(within the limit at the end) + 0.001 · (mean P over the samples), so
/// that a chain of fixes is worth something before it reaches the end.
double flight_worth(const std::vector<double>& p_within_limit);

/// Tiles under the route, of those with a P above 0, that fit the budget and give the flight a large worth.
///
/// From `start`, the tile with the largest gain per byte is added while one fits; then tiles are taken out or forced in
/// and the rest is filled again, and a change stays when it is better: at most 400 times by the chain of fixes
/// (fix_chain.h), whose reach is that of flights with the tiles of `history`, then, when `flown`, at most 100 times
/// (60,000 samples) by predict_survival(). Gains are derivatives of the probability, which is multilinear in the P of
/// the attempts: one forward and one backward recursion give all of them (as in L. Rabiner, A tutorial on hidden Markov
/// models, Proc. IEEE 77(2), 1989). Worth and gains of the chain are means over the levels of the place; the reach is
/// that at its mean P, without wind. No bound is claimed: the problem contains the knapsack problem.
std::vector<bool> most_probable_tiles(const FlightPath& path, const std::vector<FixAttempt>& attempts,
                                      const TileChances& tile_chances, const std::vector<bool>& start,
                                      const std::vector<bool>& history, const StoredSize& size, std::int64_t budget,
                                      const FixTries& tries, bool flown, int threads);

}  // namespace pilotage
