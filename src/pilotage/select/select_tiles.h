#pragma once

#include <vector>

#include "pilotage/ground/score_table.h"
#include "pilotage/mission/mission.h"
#include "pilotage/mission/selection.h"
#include "pilotage/mission/stored_size.h"
#include "pilotage/select/select_options.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// Whether a frame can be expected to match this tile: scored, and its probability of a correct fix, where it is known,
/// is at least min_p_correct_fix; else its peak stands min_peak_margin above every rival. Judged on degraded copies; on
/// the clean surface only where no degraded one was computed, because clean uniqueness can point the wrong way
/// (docs/methods/uniqueness.md). A tile without either is judged by its status alone; where no
/// stored tile has either, Selection::matchability_judged is false.
bool is_matchable(const TileScores& score, const SelectOptions& options);

/// Chooses the tiles that are stored and predicts what the flight looks like with them.
///
/// Default: every matchable tile. `sparse`: the fewest matching areas such that no gap lets the error exceed the limit
/// (greedy interval cover along the route); an area is every matchable tile whose centre lies within the corridor's
/// half width of the point of the fix, because the aircraft may be anywhere in it. `budget`: first the sparse areas,
/// then the remaining matchable tiles, nearest to the route first and by margin among equals, while they fit. Where
/// tiles have a P of a correct fix, the tiles under the route are chosen for the largest P that the error stays within
/// its limit (budget_tiles.h), if that gives more than this order does.
///
/// Where at least one tile has a P, the flight's chances are computed (route_probability.h); a matchable tile without
/// one counts as P = 1, and a note says so. `advise` looks for a parallel line for each leg that is not good enough.
///
/// Gaps are, and areas and a budget are sought for, only where the plan's GNSS is denied; fixes are taken over all that
/// is stored. Where GNSS may be lost anywhere, tiles are chosen for its loss at the first point, the worst there is,
/// and what is predicted is the flight that loses it at the worst point that is found (worst_loss.h).
///
/// Throws UsageError for options out of range or a budget that cannot hold an empty map, DataError when a score is not
/// of this plan, or stored tiles count imagery of different ages.
Selection select_tiles(const Mission& mission, const std::vector<TileScores>& scores, const StoredSize& size,
                       const SelectOptions& options, int threads = 1);

}  // namespace pilotage

#pragma GCC visibility pop
