#pragma once

#include <functional>
#include <vector>

#include "pilotage/report/report.h"

namespace pilotage {

/// What of a ground the page's map shows, and how its grid lies on Earth; as in ReportInput. What it refers to must
/// outlive it.
struct ShownGround {
  const Ground& ground;
  const Raster& imagery;
  const TilePictures& pictures;
  const std::function<GeodeticPoint(Eigen::Vector2d)>& geodetic_from_map;
};
ShownGround shown_ground(const ReportInput& input);

/// The map of a ground that nobody flies over: its tiles' cells, imagery and pictures. `tiles` are all of the ground's,
/// in their order.
ReportDisplay make_display(const ShownGround& shown, const std::vector<ReportTile>& tiles);

/// The pictures and shapes of the page's map for the tiles, legs and gaps of `report`, in their order.
ReportDisplay make_display(const ReportInput& input, const Report& report);

}  // namespace pilotage
