#include "pilotage/select/planned_flight.h"

namespace pilotage {

std::vector<bool> stored_tiles(const Mission& mission, const Selection& selection) {
  std::vector<bool> stored(mission.ground.tiles.size(), false);
  for (const std::int64_t id : selection.tile_ids) stored[tile_index(mission.ground, id, "selection")] = true;
  return stored;
}

GnssAvailability planned_gnss(const Mission& mission, const Selection& selection) {
  if (!selection.loss_anywhere) return gnss_availability(mission.flight);
  const LossAnywhere& loss = *selection.loss_anywhere;
  return gnss_lost_at(mission.flight, loss.points[loss.worst].distance_m);
}

}  // namespace pilotage
