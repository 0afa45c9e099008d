#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "pilotage/camera/route_camera.h"
#include "pilotage/geo/geodetic_point.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// A point that the aircraft flies through. Heights are NaN where the file does not tell them; a vertex has one of the
/// two heights, and where it has both, the height above ground is the one that is flown.
struct RouteVertex {
  GeodeticPoint point;
  double amsl_m = std::numeric_limits<double>::quiet_NaN();     ///< Height above mean sea level (EGM96 geoid).
  double agl_m = std::numeric_limits<double>::quiet_NaN();      ///< Height above the ground.
  double speed_mps = std::numeric_limits<double>::quiet_NaN();  ///< Over ground, of the legs that lead to it.
  int source_item = -1;    ///< Index of the item in the file that it came from (RouteItem::index); -1 for home.
  std::string kind;        ///< What the item is: "waypoint", "takeoff", "survey", "home", "return", "track point", …
  bool on_ground = false;  ///< Landing: the aircraft touches the ground here, or nearly.
};

/// A leg flies the WGS 84 geodesic between two vertices. Legs stand in the order of flight, and each distinct leg
/// stands once: where a mission loops, leg i + 1 may start elsewhere than leg i ends. No leg has length 0: a vertical
/// climb is two vertices at one place without a leg between them.
struct RouteLeg {
  int from = 0;  ///< Index of a vertex.
  int to = 0;
  double length_m = 0;
};

/// What became of one item (mission command, feature) of the file.
struct RouteItem {
  /// In mission files the number by which QGroundControl shows it (WPL: the row's own; home is 0); elsewhere counted
  /// from 0 in the order of the file.
  int index = 0;
  int command = -1;    ///< MAV_CMD, -1 where the file has no such thing.
  std::string what;    ///< "waypoint", "survey", "camera trigger distance", "track \"north\"", …
  std::string became;  ///< "2 vertices", "left out: a region of interest is not flown to", …
};

/// Where the aircraft starts and returns to. NaN height where the file does not tell it.
struct RouteHome {
  GeodeticPoint point;
  double amsl_m = std::numeric_limits<double>::quiet_NaN();
};

struct Route {
  std::string name;    ///< Name of the file, without its folder.
  std::string format;  ///< "QGroundControl plan", "QGC WPL 110", "GPX", …
  std::vector<RouteVertex> vertices;
  std::vector<RouteLeg> legs;
  std::optional<RouteHome> home;
  std::optional<RouteCamera> camera;
  std::vector<RouteItem> items;
  /// Each assumption made and each item left out, as sentences for the planner.
  std::vector<std::string> notes;
};

/// A point of a sampled leg (sample_route.h).
struct RouteSample {
  GeodeticPoint point;
  int leg = 0;
  double distance_m = 0;   ///< From the start of the route: the lengths of the legs before, and the way along this one.
  double azimuth_deg = 0;  ///< Direction of flight, clockwise from north.
  double amsl_m = std::numeric_limits<double>::quiet_NaN();
  double agl_m = std::numeric_limits<double>::quiet_NaN();
  double speed_mps = std::numeric_limits<double>::quiet_NaN();
};

/// Sum of the lengths of the legs.
double route_length_m(const Route& route);

}  // namespace pilotage

#pragma GCC visibility pop
