#include "pilotage/route/sample_route.h"

#include <algorithm>
#include <cmath>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/text.h"
#include "pilotage/geo/geodesic.h"

namespace pilotage {
namespace {

double ground_m(const TerrainHeight& terrain, GeodeticPoint point) {
  return terrain ? terrain(point) : kNaN;
}

std::string place(GeodeticPoint point) {
  return "lat " + format_fixed(point.lat_deg, 6) + ", lon " + format_fixed(point.lon_deg, 6);
}

std::string leg_text(const Route& route, const RouteLeg& leg) {
  const auto end = [&](int index) {
    const RouteVertex& vertex = route.vertices[static_cast<std::size_t>(index)];
    return vertex.kind + (vertex.source_item >= 0 ? " (item " + std::to_string(vertex.source_item) + ")" : "");
  };
  return "the leg from vertex " + std::to_string(leg.from + 1) + ", " + end(leg.from) + ", to vertex " +
         std::to_string(leg.to + 1) + ", " + end(leg.to);
}

/// Heights at the two ends, both of one kind.
struct LegHeights {
  bool above_ground = false;
  double from_m = 0;
  double to_m = 0;
};

[[noreturn]] void throw_no_ground(const Route& route, const RouteLeg& leg, const TerrainHeight& terrain,
                                  GeodeticPoint point) {
  const std::string what = route.name + ": " + leg_text(route, leg);
  if (!terrain) {
    throw DataError(what +
                    ": its height is given above sea level, so its height above ground is not known; give "
                    "--elevation or --agl-m");
  }
  throw DataError(what + ": the elevation model has no height at " + place(point) +
                  "; give one that covers the route, or --agl-m");
}

LegHeights leg_heights(const Route& route, const RouteLeg& leg, const TerrainHeight& terrain) {
  const RouteVertex& from = route.vertices[static_cast<std::size_t>(leg.from)];
  const RouteVertex& to = route.vertices[static_cast<std::size_t>(leg.to)];
  if (std::isfinite(from.agl_m) && std::isfinite(to.agl_m)) return {true, from.agl_m, to.agl_m};
  const auto amsl = [&](const RouteVertex& vertex) {
    if (std::isfinite(vertex.amsl_m)) return vertex.amsl_m;
    if (!std::isfinite(vertex.agl_m)) {
      throw DataError(route.name + ": " + leg_text(route, leg) + ": there is no height at " + place(vertex.point) +
                      "; give --agl-m, or where the file has heights what they are above, with --home-amsl-m or "
                      "--height-reference (`pilotage inspect` says what is missing)");
    }
    const double ground = ground_m(terrain, vertex.point);
    if (!std::isfinite(ground)) throw_no_ground(route, leg, terrain, vertex.point);
    return ground + vertex.agl_m;
  };
  return {false, amsl(from), amsl(to)};
}

void set_heights(const Route& route, const RouteLeg& leg, const LegHeights& heights, double fraction,
                 const TerrainHeight& terrain, RouteSample& sample) {
  const double height_m = heights.from_m + fraction * (heights.to_m - heights.from_m);
  const double ground = ground_m(terrain, sample.point);
  if (heights.above_ground) {
    sample.agl_m = height_m;
    sample.amsl_m = std::isfinite(ground) ? ground + height_m : kNaN;
  } else {
    if (!std::isfinite(ground)) throw_no_ground(route, leg, terrain, sample.point);
    sample.amsl_m = height_m;
    sample.agl_m = height_m - ground;
  }
  if (sample.agl_m >= 0) return;
  const bool touches_ground = route.vertices[static_cast<std::size_t>(leg.from)].on_ground ||
                              route.vertices[static_cast<std::size_t>(leg.to)].on_ground;
  if (!touches_ground || sample.agl_m < -kLandingTolerance_m) {
    throw DataError(route.name + ": " + leg_text(route, leg) + ": runs " + format_fixed(-sample.agl_m, 1) +
                    " m below the ground at " + place(sample.point) + ", " + format_fixed(sample.distance_m, 0) +
                    " m along the route; check the heights, home's height and the elevation model");
  }
  sample.agl_m = 0;
}

double wrap_azimuth(double azimuth_deg) {
  return azimuth_deg < 0 ? azimuth_deg + 360 : azimuth_deg;
}

}  // namespace

std::vector<RouteSample> sample_route(const Route& route, double step_m, const TerrainHeight& terrain) {
  if (!(step_m > 0) || !std::isfinite(step_m)) {
    throw UsageError("step_m = " + format_number(step_m) + " is not a positive length");
  }
  const double wanted = route_length_m(route) / step_m + 2.0 * static_cast<double>(route.legs.size());
  if (wanted > static_cast<double>(kMaxRouteSamples)) {
    throw UsageError("step_m = " + format_number(step_m) + " gives " + format_fixed(wanted, 0) +
                     " samples of the route, at most " + std::to_string(kMaxRouteSamples) + " are allowed");
  }
  std::vector<RouteSample> samples;
  double start_m = 0;
  for (std::size_t index = 0; index < route.legs.size(); ++index) {
    const RouteLeg& leg = route.legs[index];
    const RouteVertex& from = route.vertices[static_cast<std::size_t>(leg.from)];
    const RouteVertex& to = route.vertices[static_cast<std::size_t>(leg.to)];
    const LegHeights heights = leg_heights(route, leg, terrain);
    const GeodesicLeg geodesic = geodesic_between(from.point, to.point);
    const int steps = std::max(1, static_cast<int>(std::ceil(geodesic.length_m / step_m - 1e-9)));
    for (int i = 0; i <= steps; ++i) {
      const double fraction = static_cast<double>(i) / steps;
      RouteSample sample;
      sample.leg = static_cast<int>(index);
      sample.speed_mps = to.speed_mps;
      sample.distance_m = start_m + fraction * geodesic.length_m;
      if (i == steps) {
        sample.point = to.point;
        sample.azimuth_deg = wrap_azimuth(geodesic.end_azimuth_deg);
      } else {
        sample.point =
            i == 0 ? from.point : geodesic_direct(from.point, geodesic.start_azimuth_deg, fraction * geodesic.length_m);
        sample.azimuth_deg = wrap_azimuth(geodesic_between(sample.point, to.point).start_azimuth_deg);
      }
      set_heights(route, leg, heights, fraction, terrain, sample);
      samples.push_back(sample);
    }
    start_m += geodesic.length_m;
  }
  return samples;
}

std::vector<std::string> route_height_warnings(const Route& route, const std::vector<RouteSample>& samples,
                                               const TerrainHeight& terrain, double low_agl_m) {
  std::vector<std::string> warnings;
  constexpr double kHomeTolerance_m = 30;
  const bool above_sea = std::any_of(route.vertices.begin(), route.vertices.end(),
                                     [](const RouteVertex& vertex) { return !std::isfinite(vertex.agl_m); });
  if (above_sea && route.home && std::isfinite(route.home->amsl_m)) {
    const double ground = ground_m(terrain, route.home->point);
    if (std::abs(route.home->amsl_m - ground) > kHomeTolerance_m) {
      warnings.push_back("Home is said to lie at " + format_fixed(route.home->amsl_m, 1) +
                         " m above sea level, but the elevation model has " + format_fixed(ground, 1) +
                         " m there: heights relative to home may be wrong by as much.");
    }
  }
  // One sentence for each leg that has a low stretch, at its lowest sample.
  for (std::size_t i = 0; i < samples.size();) {
    const std::size_t leg_index = static_cast<std::size_t>(samples[i].leg);
    const RouteSample* lowest = &samples[i];
    for (; i < samples.size() && static_cast<std::size_t>(samples[i].leg) == leg_index; ++i) {
      if (samples[i].agl_m < lowest->agl_m) lowest = &samples[i];
    }
    const RouteLeg& leg = route.legs[leg_index];
    const bool touches_ground = route.vertices[static_cast<std::size_t>(leg.from)].on_ground ||
                                route.vertices[static_cast<std::size_t>(leg.to)].on_ground;
    if (lowest->agl_m < low_agl_m && !touches_ground) {
      warnings.push_back("Only " + format_fixed(lowest->agl_m, 1) + " m above the ground at " + place(lowest->point) +
                         " (" + format_fixed(lowest->distance_m, 0) + " m along the route, " + leg_text(route, leg) +
                         ").");
    }
  }
  return warnings;
}

}  // namespace pilotage
