#pragma once

#include "pilotage/airsim/airsim_simulation.h"
#include "pilotage/simulate/rendered_world.h"

namespace pilotage {

/// Where positions of a mission's AirSim world are counted from: the first point of the route, on the ground, whose
/// height above sea level is the altitude; 0 where it is not known.
AirsimHome airsim_home(const Mission& mission, const WorldCamera& camera);

/// What an AirSim server shows of a world, which must outlive it. `camera` takes its frames, where nobody changes its
/// field of view; heights below 0.1 m above the ground are drawn from there. Throws DataError when the elevation cannot
/// be opened.
AirsimScene airsim_scene(const Mission& mission, const RenderedWorld& world, const Camera& camera);

}  // namespace pilotage
