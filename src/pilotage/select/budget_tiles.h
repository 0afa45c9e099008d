#pragma once

#include <cstdint>
#include <vector>

#include "pilotage/mission/stored_size.h"
#include "pilotage/mission/tile_plan.h"
#include "pilotage/mission/tile_scores.h"
#include "pilotage/select/fix_attempts.h"
#include "pilotage/select/route_probability.h"

namespace pilotage {

/// The tiles of `wanted` that fit, in this order while they do: those of `first`; the sparse areas, nearest to the
/// route first; the others by whole half strides from the route, and by margin among equals. Throws UsageError for a
/// budget that cannot hold an empty map.
std::vector<bool> tiles_in_order(const TilePlan& plan, const std::vector<TileScore>& scores,
                                 const std::vector<bool>& wanted, const std::vector<bool>& sparse,
                                 const std::vector<bool>& first, const StoredSize& size, std::int64_t budget);

/// Tiles under the route that fit the budget and give the flight a large probability to stay within the limit.
///
/// Maximises, over the tiles with `p_of_tile` > 0, P(within the limit at the end) + 0.001 · (mean P along the route),
/// so that a chain of fixes can grow before it reaches the end. From `start`, the tile with the largest gain per byte
/// is added while one fits; then tiles are taken out or forced in and the rest is filled again, and a change stays when
/// it is better. Gains are derivatives of the probability, which is multilinear in the P of the windows: one forward
/// and one backward recursion give all of them (as in L. Rabiner, A tutorial on hidden Markov models, Proc. IEEE 77(2),
/// 1989). How far the error lets a flight go after each fix is taken from flights with the tiles of `history`; so the
/// result is to be judged by predict_survival(). No bound is claimed: the problem contains the knapsack problem.
std::vector<bool> most_probable_tiles(const FlightPath& path, const std::vector<FixAttempt>& attempts,
                                      const std::vector<double>& p_of_tile, const std::vector<bool>& start,
                                      const std::vector<bool>& history, const StoredSize& size, std::int64_t budget);

}  // namespace pilotage
