#pragma once

#include <vector>

#include "pilotage/registration/register_dates.h"

namespace pilotage {

/// A second date brought onto the reference around tiles.
struct TileRegistration {
  Registration registration;
  Bounds area_m;  ///< That was looked at: around all tiles.
};

/// Registers the second date where there are tiles (in the CRS of the grid): ties are looked for in squares as wide as
/// the largest tile that hold one. The same tiles in any order and number give the same field. Without tiles nothing is
/// looked at. Throws as register_dates and inspect_imagery.
TileRegistration register_tiles(const std::vector<std::string>& reference, const ImageryOptions& imagery,
                                const std::vector<std::string>& second, const Crs& crs,
                                const std::vector<Bounds>& tiles, const RegistrationOptions& options, int threads = 0,
                                const Progress& progress = {});

}  // namespace pilotage
