#include "pilotage/route/route_builder.h"

#include <algorithm>
#include <cmath>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/geo/geodesic.h"
#include "pilotage/route/route_size.h"

namespace pilotage {
namespace {

bool same_height(double a_m, double b_m) {
  return (std::isnan(a_m) && std::isnan(b_m)) || std::abs(a_m - b_m) < kSamePlace_m;
}

}  // namespace

GeodeticPoint checked_point(double lat_deg, double lon_deg, const std::string& where, double max_abs_lon_deg) {
  if (!std::isfinite(lat_deg) || !std::isfinite(lon_deg)) {
    throw DataError(where + ": the position lat " + format_number(lat_deg) + ", lon " + format_number(lon_deg) +
                    " is not finite");
  }
  if (std::abs(lat_deg) > 90) {
    throw DataError(where + ": latitude " + format_number(lat_deg) + " is outside [-90, 90]");
  }
  if (std::abs(lon_deg) > max_abs_lon_deg) {
    throw DataError(where + ": longitude " + format_number(lon_deg) + " is outside [" +
                    format_number(-max_abs_lon_deg) + ", " + format_number(max_abs_lon_deg) + "]");
  }
  return {std::abs(lon_deg) <= 180 ? lon_deg : wrap_lon_deg(lon_deg), lat_deg};
}

double checked_height_m(double height_m, const std::string& where) {
  if (std::isnan(height_m) || std::abs(height_m) <= 100'000) return height_m;
  throw DataError(where + ": height " + format_number(height_m) + " m is outside [-100000, 100000]");
}

int append_vertex(Route& route, const RouteVertex& vertex) {
  if (!route.vertices.empty()) {
    const RouteVertex& last = route.vertices.back();
    if (geodesic_between(last.point, vertex.point).length_m < kSamePlace_m && same_height(last.amsl_m, vertex.amsl_m) &&
        same_height(last.agl_m, vertex.agl_m)) {
      return static_cast<int>(route.vertices.size()) - 1;
    }
  }
  check_position_count(route.name, route.vertices.size() + 1);
  route.vertices.push_back(vertex);
  return static_cast<int>(route.vertices.size()) - 1;
}

bool append_leg(Route& route, int from, int to) {
  const auto place = [&](int index) { return route.vertices[static_cast<std::size_t>(index)].point; };
  const double length_m = geodesic_between(place(from), place(to)).length_m;
  if (length_m < kSamePlace_m) return false;
  route.legs.push_back({from, to, length_m});
  return true;
}

void append_waypoint(Route& route, RouteVertex vertex) {
  const int last = static_cast<int>(route.vertices.size()) - 1;
  vertex.source_item = static_cast<int>(route.items.size()) + 1;
  vertex.kind = "waypoint";
  const int index = append_vertex(route, vertex);
  if (last >= 0 && index != last) append_leg(route, last, index);
  route.items.push_back({vertex.source_item, -1, "waypoint", index != last ? "vertex" : kSamePlaceText});
}

void add_note(Route& route, const std::string& note) {
  if (std::find(route.notes.begin(), route.notes.end(), note) == route.notes.end()) route.notes.push_back(note);
}

void add_takeoff_note(Route& route, const RouteOptions& options, const std::string& home_is) {
  if (options.agl_m) return;
  const std::string above = "Heights are above the take-off, ";
  if (options.home_amsl_m) {
    add_note(route, above + "which lies at " + format_number(*options.home_amsl_m) +
                        " m above sea level, as the options say.");
  } else if (!home_is.empty() && route.home && std::isfinite(route.home->amsl_m)) {
    add_note(route, above + "whose place is " + home_is + ", " + format_fixed(route.home->amsl_m, 1) +
                        " m above sea level; --home-amsl-m says it where the aircraft starts elsewhere.");
  } else {
    add_note(route, above +
                        "whose height above sea level the file does not say: they are not known until "
                        "--home-amsl-m says it, or --agl-m gives a constant height above ground.");
  }
}

void apply_options(Route& route, const RouteOptions& options) {
  for (RouteVertex& vertex : route.vertices) {
    if (options.agl_m) {
      vertex.agl_m = *options.agl_m;
      vertex.amsl_m = std::numeric_limits<double>::quiet_NaN();
    }
    if (options.speed_mps) vertex.speed_mps = *options.speed_mps;
  }
  if (options.agl_m) {
    add_note(route, "Flown at a constant " + format_number(*options.agl_m) +
                        " m above ground, as the options say; the heights of the file are not used.");
  }
  if (options.speed_mps) {
    add_note(route, "Flown at " + format_number(*options.speed_mps) +
                        " m/s over ground, as the options say; the speeds of the file are not used.");
  }
}

void require_legs(const Route& route) {
  if (route.vertices.empty()) throw DataError(route.name + ": has no position to fly to");
  if (route.legs.empty()) {
    throw DataError(route.name + ": all positions are at one place; a route needs two places at least");
  }
}

double route_length_m(const Route& route) {
  double length_m = 0;
  for (const RouteLeg& leg : route.legs) length_m += leg.length_m;
  return length_m;
}

}  // namespace pilotage
