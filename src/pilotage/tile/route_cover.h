#pragma once

#include <span>
#include <string>
#include <vector>

#include "pilotage/ground/ground.h"
#include "pilotage/mission/mission.h"
#include "pilotage/raster/gdal_imagery.h"
#include "pilotage/raster/gray_source.h"

namespace pilotage {

/// Names the stretches of the route that lie outside the rectangle of every raster: "from 0.40 km to 1.53 km (lon …,
/// lat …), up to 570 m outside; …". "" when there are none.
std::string outside_imagery(const std::vector<FlightSample>& samples, const std::vector<ImageryInfo>& infos,
                            const Crs& crs);

/// Names the stretches of the route, of the samples of this level, that lie inside the rectangle of a raster but where
/// less than half of the ground below (a square of a quarter tile) has data, as far as they are longer than half a
/// tile: a shorter hole leaves ground in every frame. `valid` is the mask on the level's grid (open_valid_on_grid). ""
/// when there are none.
std::string over_no_data(const std::vector<FlightSample>& samples, const GridLevel& level, const GraySource& valid,
                         const std::vector<ImageryInfo>& infos, const Crs& crs);

/// "; with latitude and longitude exchanged …" where the first point of the route then lies inside the imagery, and
/// does not as it stands; else "".
std::string swapped_axes_hint(GeodeticPoint point, const std::vector<ImageryInfo>& infos);

}  // namespace pilotage
