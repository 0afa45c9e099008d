#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pilotage/base/progress.h"
#include "pilotage/ground/tile_scores.h"
#include "pilotage/mission/mission.h"
#include "pilotage/mission/selection.h"
#include "pilotage/raster/crs.h"
#include "pilotage/report/report_input.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// Longitude and latitude of points of a CRS; NaN where a point has none.
std::function<GeodeticPoint(Eigen::Vector2d)> geodetic_from_map_of(const Crs& crs);

/// What a report computes its numbers and sentences from. `inputs`: input_files of the plan.
ReportInput make_report_input(const Mission& mission, const std::vector<TileScores>& scores, const Selection& selection,
                              const std::vector<InputFile>& inputs = {}, const std::string& software_version = "");

/// Reads what the page shows besides: a picture of the corridor, one of each tile, and what the camera will see along
/// the route: rendered from `second_date` where that is given, a second date as the imagery shows the ground, else from
/// the imagery itself, which is `own_imagery` where that is open already. The same for any number of threads (0 = all
/// cores). Throws DataError when imagery cannot be read, Interrupted.
void add_pictures(ReportInput& input, int threads = 0, const Progress& progress = {}, const OpenLevel& second_date = {},
                  const OpenLevel& own_imagery = {});

}  // namespace pilotage

#pragma GCC visibility pop
