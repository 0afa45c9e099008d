#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pilotage/base/options.h"
#include "pilotage/camera/camera_options.h"
#include "pilotage/raster/gdal_imagery.h"
#include "pilotage/score/score_tiles.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// The search radius of a survey whose planner names none.
inline constexpr double kAssumedSearchRadius_m = 50;

/// What flies over an area, and how high: what a survey needs besides the imagery. There is no route.
struct SurveyOptions {
  CameraOptions camera;
  std::optional<double> agl_m;
  std::string elevation;
  std::optional<double> search_radius_m;
  std::optional<double> gsd_m;
  double tile_overlap = 0.5;
  std::string crs;
  std::string landmarks;
  std::optional<std::vector<std::string>> imagery_date;
  std::string flight_time;
  ImageryOptions imagery_options;
  ScoreOptions score;
  std::string title;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.group("camera", self.camera, "How the aircraft sees the ground.");
    fields.field("agl_m", self.agl_m, "Height above ground that the survey is for.", Range{1, 30000});
    fields.path("elevation", self.elevation,
                "Elevation model, for steep ground: a GDAL dataset, metres above mean sea level.");
    fields.field("search_radius_m", self.search_radius_m,
                 "How far from its place a frame is looked for; 50 if not given.", Range{1, 10000});
    fields.field("gsd_m", self.gsd_m,
                 "Working ground sample distance; chosen from camera, height and imagery if not given.",
                 Range{0.01, 1000});
    fields.field("tile_overlap", self.tile_overlap, "Share of its side that a tile has in common with the next one.",
                 Range{0, 0.95});
    fields.field("crs", self.crs, "CRS of the grid, projected in metres; chosen if not given.");
    fields.path("landmarks", self.landmarks,
                "Also show where landmarks promise a fix: a file of landmark-score --for-map.");
    fields.field(
        "imagery_date", self.imagery_date,
        "Date of the imagery in UTC, as 2023-06-14 or 2023-06-14T10:30:00Z: one for all, or one for each; that "
        "of its metadata if not given.");
    fields.field(
        "flight_time", self.flight_time,
        "When it is flown, in UTC, as 2026-06-01 or 2026-06-01T09:30:00Z: how old the imagery is then is said, "
        "and P(correct fix) counts it.");
    ImageryOptions::describe(self.imagery_options, fields);
    fields.group("score", self.score, "How tiles are scored.", FlagPrefix::kNone);
    fields.field("title", self.title, "Title of the page; the imagery's name if not given.");
  }
};

}  // namespace pilotage

#pragma GCC visibility pop
