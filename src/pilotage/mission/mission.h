#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pilotage/camera/camera.h"
#include "pilotage/ground/ground.h"
#include "pilotage/ins/ins_options.h"
#include "pilotage/mission/autopilot.h"
#include "pilotage/mission/flight_conditions.h"
#include "pilotage/route/route.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// A point of the route on the grid of the ground.
struct FlightSample : RouteSample {
  Eigen::Vector2d point_map_m = Eigen::Vector2d::Zero();
  int level = kNoLevel;

  /// Too low for any level: just after take-off or before landing.
  static constexpr int kNoLevel = -1;
};

/// Where a tile lies along the route.
struct RoutePlace {
  double distance_m = 0;  ///< Of the nearest point of the route, along the route.
  double offset_m = 0;    ///< Distance of the tile's centre from that point.
};

/// A stretch of the route over which GNSS is denied.
struct DeniedStretch {
  double from_distance_m = 0;  ///< Along the route.
  double to_distance_m = 0;
};

/// Where GNSS cannot be had. Neither of the two: from the first point on, for good.
struct GnssDenial {
  std::vector<DeniedStretch> stretches;  ///< In the order of the route and apart; none is empty.
  bool anywhere = false;                 ///< It is lost at one point, whichever, for good: the worst point decides.
  std::vector<std::string> files;        ///< Of polygons, as given; the stretches lie in them.

  bool from_start() const { return stretches.empty() && !anywhere; }
};

/// How often cloud or fog hides the ground from the aircraft, by a table of the planner's.
struct GroundHidden {
  double fraction = 0;  ///< Of the time, in the month of the flight and, where the table has hours, at its hour.
  std::string file;     ///< As given.
};

/// A flight over a ground: the route, what sees, what navigates, and how far off it may be.
struct Flight {
  std::string route_file;  ///< As given.
  Route route;
  std::vector<FlightSample> samples;  ///< The route every few metres, heights above ground resolved.
  double min_agl_m = 0;               ///< Below it no matching is expected.
  Camera camera;
  InsOptions ins;
  FlightConditions conditions;
  GnssDenial denied;
  std::optional<Autopilot> autopilot;  ///< Nothing where the planner did not say.
  std::optional<GroundHidden> ground_hidden;
  double max_error_m = 0;  ///< The position error (k·σ) that the mission allows.
  /// Height above sea level of the flat ground that is assumed where no elevation model is given; nothing where none
  /// is needed.
  std::optional<double> flat_ground_amsl_m;
  bool max_error_assumed = false;  ///< The planner named none.
  double corridor_half_width_m = 0;
  double footprint_width_m = 0;  ///< At the route's typical height above ground.
  double footprint_height_m = 0;
  std::vector<RoutePlace> places;  ///< Of each tile of the ground, in their order.
};

/// What `tile` makes and the other stages read (plan.json): a ground and a flight over it.
struct Mission {
  Ground ground;
  Flight flight;
  std::vector<std::string> warnings;  ///< What the planner should look at.
  std::vector<std::string> notes;     ///< What was chosen, and why.
};

}  // namespace pilotage

#pragma GCC visibility pop
