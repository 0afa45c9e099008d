#include "pilotage/reroute/planned_line.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pilotage/base/error.h"
#include "pilotage/base/options_json.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/base/utf8.h"
#include "pilotage/geo/geodesic.h"
#include "pilotage/route/qgc_geofence.h"
#include "pilotage/route/qgc_plan.h"
#include "pilotage/route/qgc_plan_writer.h"
#include "pilotage/route/read_route.h"

namespace pilotage {
namespace {

constexpr double kSamePoint_m = 1;
constexpr double kLeastShareOfWay = 0.2;  // between the ends of what moves; below it the route is a loop

GeodeticPoint point_of(const std::vector<double>& lon_lat, const char* option) {
  if (lon_lat.size() != 2) {
    throw UsageError(std::string(option) + " has " + std::to_string(lon_lat.size()) +
                     " numbers; it is a longitude and a latitude, as 16.4843,55.4950");
  }
  if (!(std::abs(lon_lat[1]) <= 90)) {
    throw UsageError(std::string(option) + ": the latitude " + format_number(lon_lat[1]) +
                     " is outside [-90, 90]; the longitude comes first");
  }
  return {lon_lat[0], lon_lat[1]};
}

// Which legs stay as they are.
std::vector<bool> kept_legs(const LineOptions& options, const Route& route) {
  std::vector<bool> kept(route.legs.size(), false);
  for (const double number : options.keep) {
    if (number != std::floor(number) || number < 1 || number > static_cast<double>(kept.size())) {
      throw UsageError("keep = " + format_number(number) + " is no leg of the route, which has legs 1 to " +
                       std::to_string(kept.size()));
    }
    kept[static_cast<std::size_t>(number) - 1] = true;
  }
  const auto goes_on_by_itself = [](const RouteVertex& from, const RouteVertex& to) {
    if (to.kind == "takeoff" || to.kind == "VTOL takeoff") return true;
    return from.source_item >= 0 && from.source_item == to.source_item && to.kind != "spline waypoint";
  };
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const RouteVertex& from = route.vertices[static_cast<std::size_t>(route.legs[i].from)];
    const RouteVertex& to = route.vertices[static_cast<std::size_t>(route.legs[i].to)];
    if (goes_on_by_itself(from, to)) kept[i] = true;
  }
  if (std::find(kept.begin(), kept.end(), false) == kept.end()) {
    throw UsageError("every leg of " + route.name +
                     " is to be kept (keep, or a takeoff, survey, circle or landing "
                     "pattern); there is nothing that may move");
  }
  return kept;
}

void refuse_loops(const PlannedLine& planned, bool keep_waypoints) {
  const Route& route = planned.route;
  for (const MovableRun& run : movable_runs(planned.kept, keep_waypoints)) {
    double way_m = 0;
    for (std::size_t leg = run.first; leg <= run.last; ++leg) way_m += route.legs[leg].length_m;
    const RouteVertex& from = route.vertices[static_cast<std::size_t>(route.legs[run.first].from)];
    const RouteVertex& to = route.vertices[static_cast<std::size_t>(route.legs[run.last].to)];
    const double apart_m = geodesic_between(from.point, to.point).length_m;
    if (apart_m >= kLeastShareOfWay * way_m) continue;
    throw DataError("legs " + std::to_string(run.first + 1) + " to " + std::to_string(run.last + 1) + " of " +
                    planned.name + ", " + format_fixed(way_m / 1000, 2) + " km, lead back to " +
                    format_fixed(apart_m, 0) +
                    " m from where they begin, so that the cheapest line would leave the mission out; keep every "
                    "waypoint (--keep-waypoints), or some legs (--keep)");
  }
}

}  // namespace

TileOptions options_for_plan(TileOptions options, const std::filesystem::path& plan) {
  options.route = plan.string();
  options.route_options.height_reference = HeightReference::kAuto;
  options.route_options.layer.clear();
  options.route_options.feature.clear();
  return options;
}

nlohmann::ordered_json plan_of_points(const LineOptions& line, const RouteOptions& options) {
  if (!options.agl_m || !options.speed_mps) {
    throw UsageError("from and to say neither height nor speed; give --agl-m and --speed-mps");
  }
  Route route;
  route.name = "from and to";
  for (const auto& [numbers, name] : {std::pair(&line.from, "from"), std::pair(&line.to, "to")}) {
    RouteVertex vertex;
    vertex.point = point_of(*numbers, name);
    vertex.agl_m = *options.agl_m;
    vertex.speed_mps = *options.speed_mps;
    vertex.kind = "waypoint";
    route.vertices.push_back(vertex);
  }
  const double length_m = geodesic_between(route.vertices[0].point, route.vertices[1].point).length_m;
  if (length_m < kSamePoint_m) {
    throw DataError("from and to are one place, lon " + format_fixed(line.from[0], 6) + ", lat " +
                    format_fixed(line.from[1], 6));
  }
  route.legs.push_back({0, 1, length_m});
  return plan_of_route(route);
}

PlannedLine read_planned_line(const TileOptions& options, const LineOptions& line, const Route& route,
                              std::vector<std::string>& notes) {
  PlannedLine planned;
  planned.name = route.name;
  if (route.format == "QGroundControl plan") {
    planned.json = parse_json(route.name, read_file(options.route, kMaxRouteBytes));
    planned.route = route;
  } else {
    planned.json = plan_of_route(route);
    planned.route = parse_qgc_plan(route.name, planned.json, options_for_plan(options, "").route_options);
    for (const RouteItem& item : route.items) {
      if (item.became.starts_with("left out")) {
        notes.push_back("item " + std::to_string(item.index) + " (" + item.what + ") of " + route.name +
                        " is not in the new plan: " + item.became.substr(std::string("left out: ").size()));
      }
    }
  }
  require_one_line(planned.route);
  planned.kept = kept_legs(line, planned.route);
  refuse_loops(planned, line.keep_waypoints);
  return planned;
}

std::vector<MovableRun> movable_runs(const std::vector<bool>& kept, bool keep_waypoints) {
  std::vector<MovableRun> runs;
  for (std::size_t leg = 0; leg < kept.size(); ++leg) {
    if (kept[leg]) continue;
    const bool goes_on = !runs.empty() && runs.back().last + 1 == leg && !keep_waypoints;
    if (goes_on) {
      runs.back().last = leg;
    } else {
      runs.push_back({leg, leg});
    }
  }
  return runs;
}

NoFlyZones read_zones(const PlannedLine& planned, const LineOptions& options) {
  NoFlyZones zones;
  zones.margin_m = options.avoid_margin_m;
  const QgcGeofence fence = parse_qgc_geofence(planned.name, planned.json);
  zones.inside_any = fence.inside_any;
  const std::string source = "the geofence of " + planned.name;
  for (const GeodeticArea& area : fence.excluded) zones.zones.push_back({area, source, false});
  for (const GeodeticArea& area : fence.included) zones.zones.push_back({area, source, true});
  for (const std::string& file : options.avoid) {
    for (const GeodeticArea& area : read_areas(file)) zones.zones.push_back({area, name_as_utf8(file), false});
  }
  return zones;
}

}  // namespace pilotage
