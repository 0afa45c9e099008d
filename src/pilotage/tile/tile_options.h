#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pilotage/base/options.h"
#include "pilotage/camera/camera_options.h"
#include "pilotage/ins/ins_options.h"
#include "pilotage/mission/autopilot.h"
#include "pilotage/mission/flight_conditions.h"
#include "pilotage/raster/gdal_imagery.h"
#include "pilotage/route/route_options.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// The position error that is allowed where the planner names none.
inline constexpr double kAssumedMaxError_m = 50;

/// The mission as a planner states it: imagery, route, camera, inertial system.
struct TileOptions {
  std::vector<std::string> imagery;
  std::string route;
  std::string elevation;
  std::optional<double> elevation_sigma_m;
  ImageryOptions imagery_options;
  RouteOptions route_options;
  CameraOptions camera;
  InsOptions ins;
  FlightConditions conditions;
  std::optional<std::vector<std::string>> denied;
  std::optional<std::vector<std::string>> imagery_date;
  std::string licence;
  std::string attribution;
  std::string elevation_licence;
  std::string elevation_attribution;
  std::string flight_time;
  std::optional<Autopilot> autopilot;
  std::string clouds;
  std::optional<double> max_error_m;
  std::string crs;
  std::vector<double> grid_origin_m;
  std::optional<double> gsd_m;
  std::optional<int> tile_size_px;
  double tile_overlap = 0.5;
  std::optional<double> corridor_half_width_m;
  double min_agl_m = 30;
  bool allow_uncovered = false;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.path("imagery", self.imagery, "Georeferenced imagery: GDAL datasets, later ones on top.");
    fields.path("route", self.route,
                "Route file: QGroundControl plan, QGC WPL 110, DJI mission, Litchi CSV, UgCS, KML, KMZ, GPX, GeoJSON, "
                "GeoPackage.");
    fields.path("elevation", self.elevation, "Elevation model: a GDAL dataset, metres above mean sea level.");
    fields.field("elevation_sigma_m", self.elevation_sigma_m,
                 "Standard deviation of its heights, which the map tells the matcher. Default: 1 of a model with a "
                 "height every 5 m or closer, as lidar gives it, 4 of a coarser one, as Copernicus.",
                 Range{0, 100});
    fields.field(
        "imagery_date", self.imagery_date,
        "Date of the imagery in UTC, as 2023-06-14 or 2023-06-14T10:30:00Z: one for all, or one for each; that "
        "of its metadata if not given.");
    fields.field(
        "licence", self.licence,
        "Licence of the imagery, as CC-BY-4.0 (SPDX) or in words, that stands in what is made of it; that of its "
        "metadata if not given.");
    fields.field("attribution", self.attribution, "Whom to name with the imagery; as its metadata say if not given.");
    fields.field("elevation_licence", self.elevation_licence,
                 "Licence of the elevation model; that of its metadata if not given.");
    fields.field("elevation_attribution", self.elevation_attribution,
                 "Whom to name with the elevation model; as its metadata say if not given.");
    fields.field(
        "flight_time", self.flight_time,
        "When the flight begins, in UTC, as 2026-06-01 or 2026-06-01T09:30:00Z: for the age of the imagery, which "
        "P(correct fix) counts, and for the sun.");
    fields.field("autopilot", self.autopilot, kAutopilotHelp);
    fields.path("clouds", self.clouds,
                "Table (CSV) of how often cloud hides the ground: month, hour_utc (may be left out), hidden_fraction.");
    RouteOptions::describe(self.route_options, fields);
    ImageryOptions::describe(self.imagery_options, fields);
    fields.group("camera", self.camera, "How the aircraft sees the ground.");
    fields.group("ins", self.ins, "How the position error grows without GNSS.");
    FlightConditions::describe(self.conditions, fields);
    fields.path("denied", self.denied,
                "Where GNSS is denied: stretches in km along the route as 3.2-7.5, files of polygons (GeoJSON, KML, "
                "KMZ, GeoPackage), or anywhere, for its loss at the worst point; if not given, all: from the first "
                "point on.");
    fields.field("max_error_m", self.max_error_m, "Position error (k sigma) that the mission allows; 50 if not given.",
                 Range{1, 10000});
    fields.field("crs", self.crs,
                 "CRS of the mission grid, projected in metres; chosen with the least distortion if not given.");
    fields.field("grid_origin_m", self.grid_origin_m,
                 "A corner of a tile, x and y in the CRS that crs names: missions with the same one, and the same size "
                 "and overlap of tiles, share their tiles.");
    fields.field("gsd_m", self.gsd_m,
                 "Working ground sample distance; chosen from camera, height and imagery if not given.",
                 Range{0.01, 1000});
    fields.field("tile_size_px", self.tile_size_px, "Side of a tile; the size of the camera's footprint if not given.",
                 Range{16, 8192});
    fields.field("tile_overlap", self.tile_overlap, "Share of its side that a tile has in common with the next one.",
                 Range{0, 0.95});
    fields.field("corridor_half_width_m", self.corridor_half_width_m,
                 "How far from the route tiles are cut; the allowed error if not given.", Range{1, 100000});
    fields.field("min_agl_m", self.min_agl_m, "Lower than this above the ground no matching is expected.",
                 Range{1, 30000});
    fields.field("allow_uncovered", self.allow_uncovered,
                 "Plan on where a part of the route lies outside the imagery or over no data: it becomes a gap.");
  }
};

}  // namespace pilotage

#pragma GCC visibility pop
