#pragma once

#include "pilotage/evaluate/evaluated_tiles.h"
#include "pilotage/registration/warp_field.h"

namespace pilotage {

/// Truth corrected by a registration of the other date (registration/warp_field.h): the point p of the reference with
/// p + displacement(p) = the point asked for, by fixed-point iteration, to a centimetre where the field bends by less
/// than a tenth. Where the field is not known, the displacement is that of the nearest place where it is, so that
/// ground on which no tie was found is judged like the rest; without any such place the point itself.
PlaceOnReference registered_place(const WarpField& field);

}  // namespace pilotage
