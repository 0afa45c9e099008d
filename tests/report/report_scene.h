#pragma once

#include <string>

#include "pilotage/raster/gdal_crs.h"
#include "pilotage/report/report.h"

namespace pilotage::testing {

struct ReportSceneOptions {
  GeodeticPoint origin{7.6, 51.96};
  double turn_deg = 8;        ///< Of the grid's y axis against north, so that grid and page are not parallel.
  double limit_m = 50;        ///< max_error_m of the selection.
  double matchable_from = 0;  ///< Along-route share where selected ground ends and starts again: one gap between them.
  double matchable_to = 0;
  double drift = 0.018;  ///< Metres of error per metre of gap.
  int tiles_across = 7;  ///< Columns; rows follow the route.
  int tiles_along = 48;
};

/// A CRS in metres that lies nowhere on Earth, of any name without double quotes.
Crs local_crs(const std::string& name);

/// A mission over drawn ground: two levels, a route of four legs up the middle of the corridor, tiles of every status,
/// one gap.
ReportInput report_scene(const ReportSceneOptions& options);

/// report_scene({}) flown at 18 m/s, a try every 2.5 s.
ReportInput report_scene_with_tries();

/// The report of a mission with a gap from 30 to 90 % of its route.
Report report_with_gap(double drift);

}  // namespace pilotage::testing
