#pragma once

#include <optional>
#include <vector>

#include "pilotage/ground/tile_scores.h"
#include "pilotage/mission/mission.h"
#include "pilotage/mission/selection.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// What becomes of the planned flight's chances when the same map is flown by later (Selection::ageing): the flight is
/// predicted again 6, 12, 24 and 48 months later, with the P that stored tiles then have (move_to_age). Where P is less
/// than what was asked for already, it is predicted with younger imagery besides, of half the age, a quarter …, until
/// it is enough. Where P comes down to what was asked for is looked up between two ages once, and taken for linear in
/// the logarithm of the age beside that. Four predictions to a dozen, each of which takes as long as the selection's
/// own.
///
/// Where GNSS may be lost anywhere it is lost at the point that is worst on the planned flight.
///
/// Nothing where there is no probability or no level of the place, where the P of a stored tile counts no age, where
/// the imagery is kMostAge_months old already, and where it is younger than the flight: later flights are then nearer
/// to it. Throws DataError when the selection or the scores are not of the mission, or the scores count another age
/// than the imagery has on its flight.
std::optional<RouteAgeing> age_route(const Mission& mission, const std::vector<TileScores>& scores,
                                     const Selection& selection, int threads = 1);

}  // namespace pilotage

#pragma GCC visibility pop
