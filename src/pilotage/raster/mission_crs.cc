#include "pilotage/raster/mission_crs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "pilotage/base/angle.h"
#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/geo/geodesic.h"

namespace pilotage {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kStep_m = 100;
constexpr double kNegligible = 1e-5;  // a millimetre and a half over a footprint of 150 m

std::string percent(double fraction) {
  return format_fixed(100 * fraction, fraction < 1e-3 ? 4 : 3) + " %";
}

/// Largest and smallest scale factor over points.
struct ScaleRange {
  double min = kInfinity;
  double max = 0;
};

/// The singular values of [∂(x, y)/∂(east, north)], each column a central difference over kStep_m of geodesic.
ScaleRange scale_range_at(const CrsTransform& transform, double metres_per_unit, GeodeticPoint point) {
  const auto difference = [&](double azimuth_deg) -> std::optional<Eigen::Vector2d> {
    const auto ahead = transform.map_from_geodetic(geodesic_direct(point, azimuth_deg, kStep_m / 2));
    const auto behind = transform.map_from_geodetic(geodesic_direct(point, azimuth_deg + 180, kStep_m / 2));
    if (!ahead || !behind) return std::nullopt;
    return Eigen::Vector2d((*ahead - *behind) * (metres_per_unit / kStep_m));
  };
  const auto east = difference(90);
  const auto north = difference(0);
  if (!east || !north) return {0, kInfinity};
  // Singular values of a 2 × 2 matrix from its Frobenius norm and determinant.
  const double squares = east->squaredNorm() + north->squaredNorm();
  const double determinant = std::abs(east->x() * north->y() - east->y() * north->x());
  const double sum = std::sqrt(squares + 2 * determinant);
  const double gap = std::sqrt(std::max(0.0, squares - 2 * determinant));
  return {(sum - gap) / 2, (sum + gap) / 2};
}

ScaleRange scale_range(const Crs& crs, const std::vector<GeodeticPoint>& points) {
  const CrsTransform transform(crs);
  const double metres_per_unit = crs.metres_per_unit();
  ScaleRange range;
  for (const GeodeticPoint& point : points) {
    const ScaleRange here = scale_range_at(transform, metres_per_unit, point);
    range.min = std::min(range.min, here.min);
    range.max = std::max(range.max, here.max);
  }
  return range;
}

double distortion_of(const ScaleRange& range) {
  const double distortion = std::max(std::abs(range.max - 1), std::abs(range.min - 1));
  return std::isfinite(distortion) ? distortion : kInfinity;
}

void check_route(const std::vector<GeodeticPoint>& route, double half_width_m) {
  if (route.empty()) throw UsageError("a mission CRS needs a route with at least one point");
  for (const GeodeticPoint& point : route) {
    if (!std::isfinite(point.lon_deg) || !(std::abs(point.lat_deg) <= 90)) {
      throw UsageError("route point " + format_number(point.lon_deg) + ", " + format_number(point.lat_deg) +
                       " is no longitude and latitude");
    }
  }
  if (!(half_width_m >= 0 && half_width_m <= 1e6)) {
    throw UsageError("corridor half width = " + format_number(half_width_m) + " m is outside [0, 1000000]");
  }
}

Eigen::Vector3d direction_of(GeodeticPoint point) {
  const double lon = point.lon_deg * kRadPerDeg;
  const double lat = point.lat_deg * kRadPerDeg;
  return {std::cos(lat) * std::cos(lon), std::cos(lat) * std::sin(lon), std::sin(lat)};
}

GeodeticPoint point_of(const Eigen::Vector3d& direction) {
  return {std::atan2(direction.y(), direction.x()) / kRadPerDeg,
          std::atan2(direction.z(), std::hypot(direction.x(), direction.y())) / kRadPerDeg};
}

/// Rounded so that definitions stay short; 0.0001° moves the axis by 11 m.
double rounded(double degrees) {
  return std::round(degrees * 1e4) / 1e4;
}

/// The middle of the corridor: the mean of its points as directions, which has no trouble at poles and antimeridian.
GeodeticPoint middle_of(const std::vector<GeodeticPoint>& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const GeodeticPoint& point : points) sum += direction_of(point);
  // Points all around the globe have no middle; any will do, since no projection fits them.
  const GeodeticPoint middle = sum.norm() > 1e-6 ? point_of(sum) : points.front();
  return {rounded(middle.lon_deg), rounded(middle.lat_deg)};
}

struct Parameter {
  const char* name;
  double value;
};

/// A projected CRS on WGS 84 as WKT 1, which every reader of GeoPackage knows.
Crs projected_crs(const std::string& name, const char* projection, const std::vector<Parameter>& parameters) {
  std::string wkt = "PROJCS[\"" + name +
                    "\",GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563,"
                    "AUTHORITY[\"EPSG\",\"7030\"]],AUTHORITY[\"EPSG\",\"6326\"]],PRIMEM[\"Greenwich\",0],"
                    "UNIT[\"degree\",0.0174532925199433],AUTHORITY[\"EPSG\",\"4326\"]],PROJECTION[\"" +
                    projection + "\"]";
  for (const Parameter& parameter : parameters) {
    wkt += std::string(",PARAMETER[\"") + parameter.name + "\"," + format_number(parameter.value) + "]";
  }
  return Crs::from_user_input(wkt + ",UNIT[\"metre\",1],AXIS[\"Easting\",EAST],AXIS[\"Northing\",NORTH]]");
}

struct Candidate {
  std::string name;
  Crs crs;
  double distortion = kInfinity;
};

/// `make(k)` is a projection with scale factor k on its axis; k is chosen so that the largest and the smallest scale
/// over the points lie equally far from 1. Nothing when PROJ cannot make it there.
template <class Make>
std::optional<Candidate> balanced(const std::string& name, const std::vector<GeodeticPoint>& points, const Make& make) {
  try {
    const ScaleRange range = scale_range(make(1.0), points);
    if (!(range.min > 0 && std::isfinite(range.max))) return std::nullopt;
    const double scale = std::round(2 / (range.min + range.max) * 1e8) / 1e8;
    Candidate candidate{name, make(scale), kInfinity};
    candidate.distortion = scale_distortion(candidate.crs, points);
    return candidate;
  } catch (const std::runtime_error&) {
    return std::nullopt;  // outside what the projection is defined for, such as an oblique Mercator at the pole
  }
}

Candidate standard_zone(const std::vector<GeodeticPoint>& points, GeodeticPoint middle) {
  Candidate candidate;
  if (middle.lat_deg >= 84 || middle.lat_deg < -80) {
    candidate.name = middle.lat_deg > 0 ? "UPS north" : "UPS south";
    candidate.crs = Crs::from_user_input(middle.lat_deg > 0 ? "EPSG:5041" : "EPSG:5042");  // easting first
  } else {
    const int zone = 1 + static_cast<int>(std::floor((wrap_lon_deg(middle.lon_deg) + 180) / 6));
    candidate.name = "UTM zone " + std::to_string(zone) + (middle.lat_deg >= 0 ? "N" : "S");
    candidate.crs = Crs::from_user_input("EPSG:" + std::to_string((middle.lat_deg >= 0 ? 32600 : 32700) + zone));
  }
  candidate.distortion = scale_distortion(candidate.crs, points);
  return candidate;
}

std::optional<Candidate> transverse_mercator(const std::vector<GeodeticPoint>& points, GeodeticPoint middle) {
  const std::string name = "transverse Mercator on meridian " + format_number(middle.lon_deg);
  return balanced(name, points, [&](double scale) {
    return projected_crs("Pilotage " + name, "Transverse_Mercator",
                         {{"latitude_of_origin", middle.lat_deg},
                          {"central_meridian", middle.lon_deg},
                          {"scale_factor", scale},
                          {"false_easting", 0},
                          {"false_northing", 0}});
  });
}

std::optional<Candidate> conformal_conic(const std::vector<GeodeticPoint>& points, GeodeticPoint middle) {
  // The mean parallel, not the latitude of the mean direction, which a long parallel lifts towards the pole.
  const auto [south, north] = std::minmax_element(
      points.begin(), points.end(), [](GeodeticPoint a, GeodeticPoint b) { return a.lat_deg < b.lat_deg; });
  const double parallel = rounded((south->lat_deg + north->lat_deg) / 2);
  if (std::abs(parallel) < 0.1) {
    const std::string name = "Mercator on the equator";
    return balanced(name, points, [&](double scale) {
      return projected_crs(
          "Pilotage " + name, "Mercator_1SP",
          {{"central_meridian", middle.lon_deg}, {"scale_factor", scale}, {"false_easting", 0}, {"false_northing", 0}});
    });
  }
  const std::string name = "Lambert conformal conic on parallel " + format_number(parallel);
  return balanced(name, points, [&](double scale) {
    return projected_crs("Pilotage " + name, "Lambert_Conformal_Conic_1SP",
                         {{"latitude_of_origin", parallel},
                          {"central_meridian", middle.lon_deg},
                          {"scale_factor", scale},
                          {"false_easting", 0},
                          {"false_northing", 0}});
  });
}

std::optional<Candidate> oblique_mercator(const std::vector<GeodeticPoint>& points) {
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const GeodeticPoint& point : points) {
    const Eigen::Vector3d direction = direction_of(point);
    scatter += direction * direction.transpose();
    mean += direction;
  }
  // The plane through the Earth's centre that the points leave least: its normal has the smallest eigenvalue.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
  const Eigen::Vector3d normal = solver.eigenvectors().col(0);
  const Eigen::Vector3d center = mean - mean.dot(normal) * normal;
  if (center.norm() < 1e-6) return std::nullopt;
  GeodeticPoint middle = point_of(center);
  middle = {rounded(middle.lon_deg), rounded(middle.lat_deg)};
  const Eigen::Vector3d up = direction_of(middle);
  const Eigen::Vector3d east = Eigen::Vector3d::UnitZ().cross(up).normalized();
  const Eigen::Vector3d along = normal.cross(up);
  double azimuth = rounded(std::atan2(along.dot(east), along.dot(up.cross(east))) / kRadPerDeg);
  while (azimuth <= 0) azimuth += 180;  // the axis has no direction: (0, 180]
  while (azimuth > 180) azimuth -= 180;
  if (azimuth > 90) azimuth += 180;  // (0, 90] or (270, 360]: as the projection's own quadrants
  azimuth = rounded(azimuth);
  const std::string name = "oblique Mercator through " + format_number(middle.lon_deg) + ", " +
                           format_number(middle.lat_deg) + " along azimuth " + format_number(azimuth);
  return balanced(name, points, [&](double scale) {
    return projected_crs("Pilotage " + name, "Hotine_Oblique_Mercator_Azimuth_Center",
                         {{"latitude_of_center", middle.lat_deg},
                          {"longitude_of_center", middle.lon_deg},
                          {"azimuth", azimuth},
                          {"rectified_grid_angle", azimuth},
                          {"scale_factor", scale},
                          {"false_easting", 0},
                          {"false_northing", 0}});
  });
}

}  // namespace

std::vector<GeodeticPoint> corridor_points(const std::vector<GeodeticPoint>& route, double half_width_m) {
  check_route(route, half_width_m);
  std::vector<GeodesicLeg> legs;
  double length_m = 0;
  for (std::size_t i = 1; i < route.size(); ++i) {
    legs.push_back(geodesic_between(route[i - 1], route[i]));
    length_m += legs.back().length_m;
  }
  const double step_m = std::max(100.0, length_m / 200);
  std::vector<GeodeticPoint> points;
  const auto add = [&](GeodeticPoint center, double azimuth_deg) {
    points.push_back(center);
    if (half_width_m == 0) return;
    for (const double turn_deg : {-90.0, 90.0})
      points.push_back(geodesic_direct(center, azimuth_deg + turn_deg, half_width_m));
  };
  const auto add_end = [&](GeodeticPoint center, double azimuth_deg) {
    add(center, azimuth_deg);
    if (half_width_m > 0) add(geodesic_direct(center, azimuth_deg, half_width_m), azimuth_deg);
  };
  add_end(route.front(), legs.empty() ? 180 : legs.front().start_azimuth_deg + 180);
  for (std::size_t i = 0; i < legs.size(); ++i) {
    const int steps = std::max(1, static_cast<int>(std::ceil(legs[i].length_m / step_m)));
    for (int step = 1; step <= steps; ++step) {
      // The edge stands square to the leg at this very point, not where the leg starts.
      const GeodeticPoint center =
          step == steps ? route[i + 1]
                        : geodesic_direct(route[i], legs[i].start_azimuth_deg, legs[i].length_m * step / steps);
      const double azimuth_deg =
          step == steps ? legs[i].end_azimuth_deg : geodesic_between(center, route[i + 1]).start_azimuth_deg;
      add(center, azimuth_deg);
    }
  }
  add_end(route.back(), legs.empty() ? 0 : legs.back().end_azimuth_deg);
  return points;
}

double scale_distortion(const Crs& crs, const std::vector<GeodeticPoint>& points) {
  if (!crs.is_projected()) throw UsageError("CRS \"" + crs.name() + "\" is not projected: it has no scale");
  return points.empty() ? 0 : distortion_of(scale_range(crs, points));
}

MissionCrs choose_mission_crs(const std::vector<GeodeticPoint>& route, double half_width_m) {
  const std::vector<GeodeticPoint> points = corridor_points(route, half_width_m);
  const GeodeticPoint middle = middle_of(points);
  const Candidate zone = standard_zone(points, middle);
  if (zone.distortion <= kStandardZoneDistortion) {
    return {zone.crs, zone.distortion,
            zone.name + ": its scale is within " + percent(zone.distortion) + " of true over the corridor"};
  }
  Candidate best = zone;
  // From the simplest to the most general: a candidate replaces a simpler one only where its scale is truer by more
  // than kNegligible.
  for (auto& candidate :
       {transverse_mercator(points, middle), conformal_conic(points, middle), oblique_mercator(points)}) {
    if (candidate && candidate->distortion < best.distortion - kNegligible) best = *candidate;
  }
  if (!(best.distortion <= kMaxScaleDistortion)) {
    throw DataError("no mission CRS fits the corridor: the best, " + best.name + ", distorts scale by " +
                    percent(best.distortion) + ", more than " + percent(kMaxScaleDistortion) +
                    "; split the route into several missions");
  }
  return {best.crs, best.distortion,
          best.name + ": its scale is within " + percent(best.distortion) + " of true over the corridor, that of " +
              zone.name + " within " + percent(zone.distortion)};
}

MissionCrs check_mission_crs(const Crs& crs, const std::vector<GeodeticPoint>& route, double half_width_m) {
  const std::vector<GeodeticPoint> points = corridor_points(route, half_width_m);
  if (!crs.is_projected()) {
    throw UsageError("crs \"" + crs.name() +
                     "\" is not projected; a mission grid needs metres, for instance a UTM zone");
  }
  if (crs.metres_per_unit() != 1) {
    throw UsageError("crs \"" + crs.name() + "\" has units of " + format_number(crs.metres_per_unit()) +
                     " m; a mission grid needs metres");
  }
  const double distortion = scale_distortion(crs, points);
  if (!(distortion <= kMaxScaleDistortion)) {
    throw UsageError("crs \"" + crs.name() + "\" distorts scale by " + percent(distortion) +
                     " over the corridor, more than " + percent(kMaxScaleDistortion));
  }
  return {
      crs, distortion,
      "as asked: \"" + crs.name() + "\"; its scale is within " + percent(distortion) + " of true over the corridor"};
}

}  // namespace pilotage
