#include "pilotage/route/route_line.h"

#include <algorithm>
#include <cmath>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/route/ogr_route.h"
#include "pilotage/route/read_route.h"
#include "pilotage/route/route_builder.h"
#include "pilotage/route/track_speed.h"

namespace pilotage {
namespace {

std::string list_lines(const std::vector<Line>& lines) {
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < lines.size() && i < 12; ++i) {
    texts.push_back(std::to_string(i + 1) + ": " + lines[i].what + " \"" + lines[i].name + "\" of layer \"" +
                    lines[i].layer + "\" (" + std::to_string(lines[i].point_count()) + " points)");
  }
  if (lines.size() > texts.size()) texts.push_back("and " + std::to_string(lines.size() - texts.size()) + " more");
  return join(texts, "; ");
}

}  // namespace

Line choose_line(Route& route, std::vector<Line> lines, const RouteOptions& options) {
  if (!options.layer.empty()) {
    const auto all = lines;
    std::erase_if(lines, [&](const Line& line) { return line.layer != options.layer; });
    if (lines.empty()) {
      throw DataError(route.name + ": layer \"" + options.layer + "\" holds no line" +
                      (all.empty() ? "" : "; there are " + list_lines(all)));
    }
  }
  if (lines.empty()) throw DataError(route.name + ": has no position to fly to (no line and no point)");
  std::vector<std::size_t> matches;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (options.feature.empty() || lines[i].name == options.feature) matches.push_back(i);
  }
  const auto number = parse_number(options.feature);
  if (matches.empty() && number && *number >= 1 && *number <= static_cast<double>(lines.size()) &&
      *number == std::floor(*number)) {
    matches.push_back(static_cast<std::size_t>(*number) - 1);
  }
  if (matches.size() != 1) {
    const std::string asked = options.feature.empty() ? "" : " named \"" + options.feature + "\"";
    const std::string message = route.name + ": has " + std::to_string(matches.size()) + " lines" + asked +
                                " to fly; choose one with --layer and --feature (name or number): " + list_lines(lines);
    if (!options.feature.empty()) throw DataError(message);
    std::vector<RouteChoice> choices;
    for (const Line& line : lines) choices.push_back({line.layer, line.name, line.what, line.point_count()});
    throw SeveralRoutesError(message, std::move(choices));
  }
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (i == matches[0]) continue;
    route.items.push_back({static_cast<int>(route.items.size()), -1, lines[i].what + " \"" + lines[i].name + "\"",
                           "left out: another line was chosen"});
  }
  return lines[matches[0]];
}

void append_line(Route& route, const Line& line) {
  const int item = static_cast<int>(route.items.size());
  int last = -1;
  double last_time_s = std::numeric_limits<double>::quiet_NaN();
  double longest_join_m = 0;
  TrackTimes times;
  for (std::size_t part = 0; part < line.parts.size(); ++part) {
    for (std::size_t i = 0; i < line.parts[part].size(); ++i) {
      const LinePoint& point = line.parts[part][i];
      const std::string where =
          route.name + ": " + line.what + " \"" + line.name + "\", point " + std::to_string(i + 1);
      RouteVertex vertex;
      vertex.point = checked_point(point.y, point.x, where, 360);
      if (std::isinf(point.z_m)) throw DataError(where + ": its height is not finite");
      vertex.amsl_m = checked_height_m(point.z_m, where);
      vertex.source_item = item;
      vertex.kind = line.what == "points" ? "waypoint" : line.what + " point";
      const int index = append_vertex(route, vertex);
      const bool flown = last >= 0 && index != last && append_leg(route, last, index);
      const bool joins = i == 0 && part > 0;
      if (flown && joins) longest_join_m = std::max(longest_join_m, route.legs.back().length_m);
      // What passes between two parts is not known to be flight.
      const double passed_s = joins ? std::numeric_limits<double>::quiet_NaN() : point.time_s - last_time_s;
      if (flown) times.steps.push_back({index, route.legs.back().length_m, passed_s});
      if (!flown && passed_s > 0) times.still_s += passed_s;
      times.any = times.any || std::isfinite(point.time_s);
      last_time_s = point.time_s;
      last = index;
    }
  }
  if (longest_join_m > 0) {
    add_note(route, "The " + std::to_string(line.parts.size()) + " parts of the " + line.what +
                        " are joined by straight legs in the order of the file; the longest of them has " +
                        format_fixed(longest_join_m, 0) + " m.");
  }
  if (times.any) set_track_speeds(route, times);
  route.items.push_back(
      {item, -1, line.what + " \"" + line.name + "\"", std::to_string(route.vertices.size()) + " vertices"});
}

void resolve_heights(Route& route, const Line& line, const RouteOptions& options) {
  if (options.agl_m) return;
  const HeightReference reference =
      options.height_reference == HeightReference::kAuto ? line.heights : options.height_reference;
  std::size_t known = 0;
  for (const RouteVertex& vertex : route.vertices) known += std::isnan(vertex.amsl_m) ? 0 : 1;
  if (known == 0) {
    add_note(route, "The file tells no heights.");
    return;
  }
  if (known < route.vertices.size()) {
    add_note(route, std::to_string(route.vertices.size() - known) + " of " + std::to_string(route.vertices.size()) +
                        " positions have no height.");
  }
  const auto for_each = [&](const auto& change) {
    for (RouteVertex& vertex : route.vertices) change(vertex);
  };
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  switch (reference) {
    case HeightReference::kAuto:
      for_each([&](RouteVertex& vertex) { vertex.amsl_m = kNone; });
      add_note(route,
               "The heights of the file are not used, because it does not say what they are measured from; "
               "--height-reference says it.");
      break;
    case HeightReference::kAmsl:
      add_note(route, "Heights are taken as above mean sea level (EGM96).");
      break;
    case HeightReference::kEllipsoid:
      bring_to_sea_level(route.name, route.vertices);
      add_note(route, "Heights above the WGS 84 ellipsoid were brought to sea level with the EGM96 geoid.");
      break;
    case HeightReference::kAgl:
      for_each([&](RouteVertex& vertex) {
        vertex.agl_m = vertex.amsl_m;
        vertex.amsl_m = kNone;
      });
      add_note(route, "Heights are taken as above the ground.");
      break;
    case HeightReference::kHome:
      if (!options.home_amsl_m) {
        throw UsageError("height_reference = home needs home_amsl_m, the height of the launch site above sea level");
      }
      for_each([&](RouteVertex& vertex) { vertex.amsl_m += *options.home_amsl_m; });
      add_note(route, "Heights are taken as above the launch site, which lies at " +
                          format_number(*options.home_amsl_m) + " m above sea level.");
      break;
  }
}

}  // namespace pilotage
