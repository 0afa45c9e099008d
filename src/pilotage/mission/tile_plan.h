#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "pilotage/camera/camera.h"
#include "pilotage/geo/bounds.h"
#include "pilotage/geo/geodetic_point.h"
#include "pilotage/geo/tile_matrix.h"
#include "pilotage/ins/ins_options.h"
#include "pilotage/raster/gdal_imagery.h"
#include "pilotage/route/route.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// A tile of the plan: a square of ground of the size of the camera's footprint.
struct PlanTile {
  std::int64_t tile_id = 0;  ///< Unique over all levels; ascending in (level, row, column).
  int level = 0;
  std::int64_t column = 0;
  std::int64_t row = 0;
  Bounds bounds;  ///< In the CRS of the mission grid.
  GeodeticPoint center;
  double valid_fraction = 0;    ///< Share of its pixels that the imagery covers, 0 … 1.
  double route_distance_m = 0;  ///< Of the nearest point of the route, along the route.
  double route_offset_m = 0;    ///< Distance of the tile's centre from that point.
};

/// A level of the plan serves one band of heights above ground.
struct PlanLevel {
  TileMatrix matrix;
  double gsd_m = 0;
  double min_agl_m = 0;
  double max_agl_m = 0;
  int search_radius_px = 0;
};

/// A point of the route on the mission grid.
struct PlanSample : RouteSample {
  Eigen::Vector2d point_map_m = Eigen::Vector2d::Zero();
  int level = kNoLevel;

  /// Too low for any level: just after take-off or before landing.
  static constexpr int kNoLevel = -1;
};

struct PlanImagery {
  std::string dataset;  ///< As given: a GDAL dataset string.
  double gsd_m = 0;
  std::string crs;
  std::string acquired;  ///< Date of the imagery where its metadata tell, else "".
  int width_px = 0;
  int height_px = 0;
};

/// What `tile` makes and the other stages read: the mission grid and its tiles, with everything they were made from.
struct TilePlan {
  std::string crs_wkt;
  std::string crs_name;
  double max_scale_distortion = 0;  ///< Largest |scale − 1| of the grid over the corridor.
  std::vector<PlanLevel> levels;
  std::vector<PlanTile> tiles;  ///< Ascending tile_id.
  std::vector<PlanImagery> imagery;
  ImageryOptions imagery_options;
  std::string elevation;   ///< GDAL dataset string, "" when none was given.
  std::string route_file;  ///< As given.
  Route route;
  std::vector<PlanSample> route_samples;  ///< The route every few metres, heights above ground resolved.
  double min_agl_m = 0;                   ///< Below it no matching is expected.
  Camera camera;
  InsOptions ins;
  double max_error_m = 0;  ///< The position error (k·σ) that the mission allows.
  double corridor_half_width_m = 0;
  double footprint_width_m = 0;  ///< At the route's typical height above ground.
  double footprint_height_m = 0;
  std::vector<std::string> warnings;  ///< What the planner should look at.
  std::vector<std::string> notes;     ///< What was chosen, and why.
};

}  // namespace pilotage

#pragma GCC visibility pop
