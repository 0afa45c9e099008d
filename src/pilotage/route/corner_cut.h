#pragma once

#include "pilotage/geo/geodetic_point.h"
#include "pilotage/route/route.h"

namespace pilotage {

/// The most by which a turn that begins and ends `turn_starts_m` before and behind `corner` can leave the straight legs
/// before → corner → after: the distance of the corner from the chord between the ends of the turn,
/// turn_starts_m · sin(θ / 2) with the change of course θ. A turn inside the triangle of corner and chord is assumed,
/// whatever its form. The start is limited to the length of the shorter leg. 0 when there is no turn.
double corner_cut_m(GeodeticPoint before, GeodeticPoint corner, GeodeticPoint after, double turn_starts_m);

/// The note about turns that cut corners by up to `widest_m`; none below a centimetre.
void add_corner_note(Route& route, double widest_m);

}  // namespace pilotage
