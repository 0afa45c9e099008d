#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pilotage/base/options.h"
#include "pilotage/prepare/prepare.h"

namespace pilotage {

/// What may move of a planned line, and what it costs.
struct LineOptions {
  std::vector<double> from;
  std::vector<double> to;
  std::vector<double> keep;
  bool keep_waypoints = false;
  std::optional<double> keep_within_m;
  std::vector<std::string> avoid;
  double avoid_margin_m = 0;
  std::optional<double> search_within_m;
  double turn_cost_m = 100;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("from", self.from, "Longitude and latitude to start from, LON,LAT, with --to in place of a route.",
                 Range{-180, 180});
    fields.field("to", self.to, "Longitude and latitude to fly to, LON,LAT.", Range{-180, 180});
    fields.field("keep", self.keep, "Legs that stay as they are, counted from 1.", Range{1, 1e6});
    fields.field("keep_waypoints", self.keep_waypoints, "Every waypoint stays; only the way between two may move.");
    fields.field("keep_within_m", self.keep_within_m, "How far from the planned line the new one may lead.",
                 Range{1, 1e6});
    fields.path("avoid", self.avoid,
                "No-fly zones beside the plan's own geofence: files of polygons (GeoJSON, KML, KMZ, GeoPackage).");
    fields.field("avoid_margin_m", self.avoid_margin_m, "Distance to keep from no-fly zones and from the fence.",
                 Range{0, 1e5});
    fields.field("search_within_m", self.search_within_m,
                 "How far from the planned line ground is scored and searched; a quarter of its length if not given, "
                 "less where that would be more than 6000 tiles.",
                 Range{1, 1e6});
    fields.field("turn_cost_m", self.turn_cost_m, "What a turn of 90 degrees costs, as metres of way.", Range{0, 1e5});
  }
};

/// A mission as `prepare` takes it, and what `reroute` wants to know besides.
struct RerouteOptions {
  PrepareOptions mission;
  LineOptions line;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    PrepareOptions::describe(self.mission, fields);
    fields.group("reroute", self.line, "What of the line may move.", FlagPrefix::kNone);
  }
};

}  // namespace pilotage
