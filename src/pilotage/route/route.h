#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "pilotage/camera/route_camera.h"
#include "pilotage/geo/geodetic_point.h"

namespace pilotage {

/// Heights are NaN where the file does not tell them.
struct RouteVertex {
  GeodeticPoint point;
  double amsl_m = std::numeric_limits<double>::quiet_NaN();  ///< Height above mean sea level (EGM96 geoid).
  double agl_m = std::numeric_limits<double>::quiet_NaN();   ///< Height above the ground.
  double speed_mps = std::numeric_limits<double>::quiet_NaN();
  int source_item = -1;  ///< Index of the item in the file that it came from; -1 for home.
  std::string kind;      ///< What the item is: "waypoint", "takeoff", "survey", "home", "track point", …
};

/// A leg flies the WGS 84 geodesic between two vertices.
struct RouteLeg {
  int from = 0;  ///< Index of a vertex.
  int to = 0;
  double length_m = 0;
};

struct Route {
  std::string name;    ///< Name of the file, without its folder.
  std::string format;  ///< "QGroundControl plan", "QGC WPL 110", "GPX", …
  std::vector<RouteVertex> vertices;
  std::vector<RouteLeg> legs;
  std::optional<RouteCamera> camera;
  /// Each assumption made and each item left out, as sentences for the planner.
  std::vector<std::string> notes;
};

/// A point of a sampled leg.
struct RouteSample {
  GeodeticPoint point;
  int leg = 0;
  double distance_m = 0;  ///< From the start of the route, along it.
  double azimuth_deg = 0;  ///< Direction of flight, clockwise from north.
  double amsl_m = std::numeric_limits<double>::quiet_NaN();
  double agl_m = std::numeric_limits<double>::quiet_NaN();
  double speed_mps = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace pilotage
