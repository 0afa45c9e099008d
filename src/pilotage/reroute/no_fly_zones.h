#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "pilotage/mission/mission.h"
#include "pilotage/raster/crs.h"
#include "pilotage/route/ogr_areas.h"

namespace pilotage {

/// An area that lines must not enter, or must not leave, and where it was said.
struct FlyZone {
  GeodeticArea area;
  std::string source;  ///< "the geofence of route.plan", "zones.geojson".
  bool inclusion = false;
};

struct NoFlyZones {
  std::vector<FlyZone> zones;
  bool inside_any = false;  ///< QgcGeofence::inside_any.
  double margin_m = 0;      ///< To keep from their edges.
};

/// The zones on the mission grid, for many lines to be held against. Edges are straight on the grid between points at
/// most 200 m apart, which leave them by less than a centimetre.
class ZonesOnGrid {
 public:
  /// Throws DataError naming the zone when a corner has no place on the grid.
  ZonesOnGrid(const NoFlyZones& zones, const Crs& crs);

  /// Whether the straight line from a to b stays clear of every zone, and inside the fence, by the margin.
  bool clear(const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m) const;

  /// What forbids a point: the source of the zone; "" when nothing does.
  std::string forbidden_by(const Eigen::Vector2d& point_m) const;

 private:
  struct Edge {
    Eigen::Vector2d a;
    Eigen::Vector2d b;
  };
  struct Zone {
    std::vector<Edge> edges;
    Eigen::Vector2d low;
    Eigen::Vector2d high;
    bool inclusion = false;
    std::string source;
  };

  static bool lies_inside(const Zone& zone, const Eigen::Vector2d& point_m);
  bool near_edge(const Zone& zone, const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m) const;
  bool inside_fence(const Eigen::Vector2d& point_m) const;

  std::vector<Zone> zones_;
  bool union_of_inclusions_ = false;
  double margin_m_ = 0;
};

/// How much of a sampled line lies in zones that it must not enter, or outside those that it must not leave, and the
/// source of the first of them; margins are not looked at. Exact to the centimetre, as stretches_inside().
struct ForbiddenWay {
  double length_m = 0;
  std::string source;
};
ForbiddenWay forbidden_way(const NoFlyZones& zones, const std::vector<FlightSample>& samples);

}  // namespace pilotage
