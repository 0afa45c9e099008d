#include "pilotage/reroute/no_fly_zones.h"

#include <algorithm>
#include <cmath>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/geo/geodesic.h"
#include "pilotage/raster/gdal_crs.h"
#include "pilotage/tile/denied_stretches.h"

namespace pilotage {
namespace {

constexpr double kStraight_m = 200;
constexpr int kMostParts = 10'000;
constexpr double kUnionStep_m = 2;  // a line in a union of areas is looked at this often

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

double distance_to_segment_m(const Eigen::Vector2d& point, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = b - a;
  const double square = along.squaredNorm();
  const double share = square > 0 ? std::clamp((point - a).dot(along) / square, 0.0, 1.0) : 0;
  return (point - a - share * along).norm();
}

bool segments_cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
                    const Eigen::Vector2d& d) {
  const double c_side = cross(b - a, c - a);
  const double d_side = cross(b - a, d - a);
  const double a_side = cross(d - c, a - c);
  const double b_side = cross(d - c, b - c);
  return (c_side > 0) != (d_side > 0) && (a_side > 0) != (b_side > 0);
}

double segment_distance_m(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
                          const Eigen::Vector2d& d) {
  if (segments_cross(a, b, c, d)) return 0;
  return std::min({distance_to_segment_m(a, c, d), distance_to_segment_m(b, c, d), distance_to_segment_m(c, a, b),
                   distance_to_segment_m(d, a, b)});
}

}  // namespace

ZonesOnGrid::ZonesOnGrid(const NoFlyZones& zones, const Crs& crs)
    : union_of_inclusions_(zones.inside_any), margin_m_(zones.margin_m) {
  const CrsTransform transform(crs);
  for (const FlyZone& from : zones.zones) {
    Zone zone;
    zone.inclusion = from.inclusion;
    zone.source = from.source;
    zone.low.setConstant(INFINITY);
    zone.high.setConstant(-INFINITY);
    const auto placed = [&](GeodeticPoint point) {
      const auto on_grid = transform.map_from_geodetic(point);
      if (on_grid && on_grid->allFinite()) return *on_grid;
      throw DataError(from.source + ": the corner lon " + format_fixed(point.lon_deg, 6) + ", lat " +
                      format_fixed(point.lat_deg, 6) + " of a zone is too far away to have a place on the grid " +
                      crs.name());
    };
    for (const auto& ring : from.area.rings) {
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const GeodeticPoint c = ring[i];
        const GeodeticPoint d = ring[(i + 1) % ring.size()];
        const double length_m = geodesic_between(c, d).length_m;
        const int parts = static_cast<int>(std::clamp(std::ceil(length_m / kStraight_m), 1.0, double{kMostParts}));
        Eigen::Vector2d last = placed(c);
        for (int part = 1; part <= parts; ++part) {
          const double share = static_cast<double>(part) / parts;
          const Eigen::Vector2d next =
              placed({c.lon_deg + share * (d.lon_deg - c.lon_deg), c.lat_deg + share * (d.lat_deg - c.lat_deg)});
          zone.edges.push_back({last, next});
          zone.low = zone.low.cwiseMin(last);
          zone.high = zone.high.cwiseMax(last);
          last = next;
        }
      }
    }
    zones_.push_back(std::move(zone));
  }
  const auto inclusions = std::count_if(zones_.begin(), zones_.end(), [](const Zone& zone) { return zone.inclusion; });
  if (inclusions < 2) union_of_inclusions_ = false;  // one is the same either way, and looked at exactly
}

bool ZonesOnGrid::lies_inside(const Zone& zone, const Eigen::Vector2d& point_m) {
  if ((point_m.array() < zone.low.array()).any() || (point_m.array() > zone.high.array()).any()) return false;
  bool inside = false;
  for (const Edge& edge : zone.edges) {
    if ((edge.a.y() > point_m.y()) == (edge.b.y() > point_m.y())) continue;
    const double x = edge.a.x() + (point_m.y() - edge.a.y()) / (edge.b.y() - edge.a.y()) * (edge.b.x() - edge.a.x());
    if (x > point_m.x()) inside = !inside;
  }
  return inside;
}

bool ZonesOnGrid::near_edge(const Zone& zone, const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m) const {
  const Eigen::Vector2d low = a_m.cwiseMin(b_m).array() - margin_m_;
  const Eigen::Vector2d high = a_m.cwiseMax(b_m).array() + margin_m_;
  if ((high.array() < zone.low.array()).any() || (low.array() > zone.high.array()).any()) return false;
  return std::any_of(zone.edges.begin(), zone.edges.end(), [&](const Edge& edge) {
    const bool apart = std::max(edge.a.x(), edge.b.x()) < low.x() || std::min(edge.a.x(), edge.b.x()) > high.x() ||
                       std::max(edge.a.y(), edge.b.y()) < low.y() || std::min(edge.a.y(), edge.b.y()) > high.y();
    if (apart) return false;
    const double distance_m = segment_distance_m(a_m, b_m, edge.a, edge.b);
    return distance_m <= 0 || distance_m < margin_m_;
  });
}

bool ZonesOnGrid::inside_fence(const Eigen::Vector2d& point_m) const {
  return std::any_of(zones_.begin(), zones_.end(), [&](const Zone& zone) {
    return zone.inclusion && lies_inside(zone, point_m) && !(margin_m_ > 0 && near_edge(zone, point_m, point_m));
  });
}

bool ZonesOnGrid::clear(const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m) const {
  for (const Zone& zone : zones_) {
    if (zone.inclusion && union_of_inclusions_) continue;
    if (lies_inside(zone, a_m) != zone.inclusion || near_edge(zone, a_m, b_m)) return false;
  }
  if (!union_of_inclusions_) return true;
  const int parts = std::max(1, static_cast<int>(std::ceil((b_m - a_m).norm() / kUnionStep_m)));
  for (int i = 0; i <= parts; ++i) {
    if (!inside_fence(a_m + static_cast<double>(i) / parts * (b_m - a_m))) return false;
  }
  return true;
}

std::string ZonesOnGrid::forbidden_by(const Eigen::Vector2d& point_m) const {
  for (const Zone& zone : zones_) {
    if (zone.inclusion && union_of_inclusions_) continue;
    if (lies_inside(zone, point_m) != zone.inclusion || near_edge(zone, point_m, point_m)) return zone.source;
  }
  if (!union_of_inclusions_ || inside_fence(point_m)) return "";
  return std::find_if(zones_.begin(), zones_.end(), [](const Zone& zone) { return zone.inclusion; })->source;
}

ForbiddenWay forbidden_way(const NoFlyZones& zones, const std::vector<FlightSample>& samples) {
  ForbiddenWay way;
  const auto add = [&](double length_m, const std::string& source) {
    if (!(length_m > 0.05)) return;  // lengths are rounded
    if (way.source.empty()) way.source = source;
    way.length_m += length_m;
  };
  const double all_m = samples.back().distance_m;
  const auto length_of = [](const std::vector<DeniedStretch>& stretches) {
    double length_m = 0;
    for (const DeniedStretch& stretch : stretches) length_m += stretch.to_distance_m - stretch.from_distance_m;
    return length_m;
  };
  std::vector<DeniedStretch> within;  // of any inclusion
  std::string fence;
  for (const FlyZone& zone : zones.zones) {
    const std::vector<DeniedStretch> inside = stretches_inside(zone.area, samples);
    if (!zone.inclusion) {
      add(length_of(inside), zone.source);
    } else if (!zones.inside_any) {
      add(all_m - length_of(inside), zone.source);
    } else {
      within.insert(within.end(), inside.begin(), inside.end());
      fence = zone.source;
    }
  }
  if (!zones.inside_any || fence.empty()) return way;
  std::sort(within.begin(), within.end(),
            [](const DeniedStretch& a, const DeniedStretch& b) { return a.from_distance_m < b.from_distance_m; });
  double covered_m = 0;
  double reached_m = 0;
  for (const DeniedStretch& stretch : within) {
    const double from_m = std::max(reached_m, stretch.from_distance_m);
    covered_m += std::max(0.0, stretch.to_distance_m - from_m);
    reached_m = std::max(reached_m, stretch.to_distance_m);
  }
  add(all_m - covered_m, fence);
  return way;
}

}  // namespace pilotage
