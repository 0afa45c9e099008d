#include "pilotage/report/waypoints.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "pilotage/base/utf8.h"
#include "pilotage/base/wording.h"
#include "pilotage/mission/flight_time.h"
#include "pilotage/report/page_parts.h"

namespace pilotage {
namespace {

/// A time on the way as "1:02:03" or "2:03".
std::string clock_text_of(double time_s) {
  if (!std::isfinite(time_s)) return "–";
  const auto all = static_cast<std::int64_t>(std::llround(time_s));
  const auto two = [](std::int64_t number) { return (number < 10 ? "0" : "") + std::to_string(number); };
  const std::string minutes =
      all >= 3600 ? std::to_string(all / 3600) + ":" + two(all / 60 % 60) : std::to_string(all / 60);
  return minutes + ":" + two(all % 60);
}

}  // namespace

bool has_item_numbers(const Route& route) {
  return std::any_of(route.items.begin(), route.items.end(), [](const RouteItem& item) { return item.command >= 0; });
}

std::vector<Waypoint> waypoints(const Flight& flight) {
  const Route& route = flight.route;
  const bool numbered = has_item_numbers(route);
  // Where each vertex is first reached: the first sample of the leg that begins there, the last of one that ends there.
  struct Reached {
    const FlightSample* sample;
    double time_s;
  };
  std::map<int, Reached> reached;
  double time_s = 0;
  for (std::size_t i = 0; i < flight.samples.size(); ++i) {
    const FlightSample& sample = flight.samples[i];
    const bool first = i == 0 || flight.samples[i - 1].leg != sample.leg;
    if (i > 0) time_s += step_time_s(flight.samples[i - 1], sample);
    const bool last = i + 1 == flight.samples.size() || flight.samples[i + 1].leg != sample.leg;
    const RouteLeg& leg = route.legs.at(static_cast<std::size_t>(sample.leg));
    if (first) reached.try_emplace(leg.from, Reached{&sample, time_s});
    if (last) reached.try_emplace(leg.to, Reached{&sample, time_s});
  }
  std::vector<Waypoint> all;
  for (std::size_t i = 0; i < route.vertices.size(); ++i) {
    const RouteVertex& vertex = route.vertices[i];
    const auto is_of_item = [&](std::size_t other) {
      return numbered && vertex.source_item >= 0 && route.vertices[other].source_item == vertex.source_item;
    };
    const bool ends_a_curve = vertex.kind == "spline waypoint";
    if (ends_a_curve ? i + 1 < route.vertices.size() && is_of_item(i + 1) : i > 0 && is_of_item(i - 1)) continue;
    Waypoint& next = all.emplace_back();
    next.number = static_cast<int>(all.size());
    next.item = numbered ? vertex.source_item : -1;
    next.kind = vertex.kind;
    next.point = vertex.point;
    next.amsl_m = vertex.amsl_m;
    next.agl_m = vertex.agl_m;
    next.speed_mps = vertex.speed_mps;
    const auto found = reached.find(static_cast<int>(i));
    if (found == reached.end()) continue;
    next.distance_m = found->second.sample->distance_m;
    next.time_s = found->second.time_s;
    if (!std::isfinite(next.amsl_m)) next.amsl_m = found->second.sample->amsl_m;
    if (!std::isfinite(next.agl_m)) next.agl_m = found->second.sample->agl_m;
  }
  return all;
}

std::string waypoints_html(const std::vector<Waypoint>& all) {
  std::string html;
  for (std::size_t i = 0; i < std::min(all.size(), kMostWaypointsListed); ++i) {
    const Waypoint& next = all[i];
    html += "<tr>" + heading_html(std::to_string(next.number)) +
            cell_html("Item of the plan", next.item < 0 ? "–" : std::to_string(next.item)) +
            cell_html("Kind", valid_utf8(next.kind)) +
            cell_html("Latitude, longitude",
                      number_text(next.point.lat_deg, 6) + ", " + number_text(next.point.lon_deg, 6)) +
            cell_html("Above sea level", number_text(next.amsl_m, 0) + (std::isfinite(next.amsl_m) ? " m" : "")) +
            cell_html("Above ground", number_text(next.agl_m, 0) + (std::isfinite(next.agl_m) ? " m" : "")) +
            cell_html("Along the route", std::isfinite(next.distance_m) ? length_text(next.distance_m) : "–") +
            cell_html("Time", clock_text_of(next.time_s)) + "</tr>\n";
  }
  if (all.size() > kMostWaypointsListed) {
    html += "<tr><td colspan=\"8\">… and " + std::to_string(all.size() - kMostWaypointsListed) +
            " more, which stand in plan.json.</td></tr>\n";
  }
  return html.empty() ? "<tr><td colspan=\"8\">The route has no waypoint.</td></tr>\n" : html;
}

}  // namespace pilotage
