#include "pilotage/route/dji_wpml.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/text.h"
#include "pilotage/camera/camera_products.h"
#include "pilotage/raster/gdal_xml.h"
#include "pilotage/route/corner_cut.h"
#include "pilotage/route/ogr_route.h"
#include "pilotage/route/route_builder.h"
#include "pilotage/route/route_size.h"

namespace pilotage {
namespace {

enum class DjiHeights { kEllipsoid, kSeaLevel, kTakeoff, kGround };

struct DjiWaypoint {
  int index = 0;
  GeodeticPoint point;
  double height_m = kNaN;
  double speed_mps = kNaN;   ///< To the next waypoint.
  double turn_starts_m = 0;  ///< From the waypoint, where its turn cuts the corner; 0 when it does not.
  bool is_curve = false;     ///< Reached or left on a curve as a whole.
};

struct DjiWayline {
  int id = 0;
  DjiHeights heights = DjiHeights::kTakeoff;
  std::string height_mode;  ///< As the file spells it.
  std::vector<DjiWaypoint> waypoints;
};

std::optional<double> number_in(const XmlElement& element, std::string_view child, const std::string& where) {
  const std::string text = element.child_text(child);
  if (text.empty()) return std::nullopt;
  const auto number = parse_number(text);
  if (number && std::isfinite(*number)) return number;
  throw DataError(where + ": " + std::string(child) + " is \"" + text.substr(0, 40) + "\", expected a finite number");
}

std::optional<int> integer_in(const XmlElement& element, std::string_view child, const std::string& where) {
  const auto number = number_in(element, child, where);
  if (!number) return std::nullopt;
  if (*number == std::floor(*number) && *number >= 0 && *number <= 1'000'000) return static_cast<int>(*number);
  throw DataError(where + ": " + std::string(child) + " = " + format_number(*number) +
                  " is outside [0, 1000000] or no integer");
}

/// A speed over ground that can be flown at; NaN where there is none.
double speed_in(const XmlElement& element, std::string_view child, const std::string& where) {
  const double speed_mps = number_in(element, child, where).value_or(kNaN);
  return speed_mps > 0 && speed_mps <= 1000 ? speed_mps : kNaN;
}

/// The numbers of "113.9,22.5" or "22.5,113.9,32.6".
std::vector<double> numbers_of(std::string_view text, const std::string& where) {
  std::vector<double> numbers;
  while (true) {
    const auto comma = text.find(',');
    std::string_view part = text.substr(0, comma);
    const auto first = part.find_first_not_of(" \t\r\n");
    part = first == std::string_view::npos ? "" : part.substr(first, part.find_last_not_of(" \t\r\n") - first + 1);
    const auto number = parse_number(part);
    if (!number || !std::isfinite(*number)) {
      throw DataError(where + ": \"" + std::string(part.substr(0, 40)) + "\" is no finite number");
    }
    numbers.push_back(*number);
    if (comma == std::string_view::npos) return numbers;
    text.remove_prefix(comma + 1);
  }
}

DjiHeights dji_heights(const std::string& mode, const std::string& where) {
  if (mode == "WGS84") return DjiHeights::kEllipsoid;
  if (mode == "EGM96") return DjiHeights::kSeaLevel;
  if (mode == "relativeToStartPoint") return DjiHeights::kTakeoff;
  if (mode == "realTimeFollowSurface" || mode == "aboveGroundLevel") return DjiHeights::kGround;
  throw DataError(where + " is \"" + mode.substr(0, 40) +
                  "\"; known are WGS84, EGM96, relativeToStartPoint, aboveGroundLevel and realTimeFollowSurface");
}

void take_turn(const XmlElement& placemark, const XmlElement& folder, const std::string& where, DjiWaypoint& waypoint) {
  const XmlElement* turn = placemark.child("waypointTurnParam");
  const std::string mode =
      turn != nullptr ? turn->child_text("waypointTurnMode") : folder.child_text("globalWaypointTurnMode");
  std::string straight = placemark.child_text("useStraightLine");
  if (straight.empty() || placemark.child_text("useGlobalTurnParam") == "1") {
    const std::string of_all = folder.child_text("globalUseStraightLine");
    if (!of_all.empty()) straight = of_all;
  }
  const bool on_curve = mode.find("WithContinuityCurvature") != std::string::npos;
  waypoint.is_curve = on_curve && straight != "1";
  const bool turns_early =
      mode == "coordinateTurn" || (mode == "toPointAndPassWithContinuityCurvature" && straight == "1");
  if (turns_early && turn != nullptr) {
    waypoint.turn_starts_m = std::max(0.0, number_in(*turn, "waypointTurnDampingDist", where).value_or(0));
  }
}

/// The waypoint's height, and what it is above is that of its wayline.
double height_in(const XmlElement& placemark, const XmlElement& folder, bool is_executed, DjiHeights heights,
                 const std::string& where) {
  if (is_executed) return number_in(placemark, "executeHeight", where).value_or(kNaN);
  const auto own = number_in(placemark, "height", where);
  if (own) return *own;
  // The height of the whole route is above the take-off, so it serves where the waypoint's is, too.
  const bool serves = heights == DjiHeights::kTakeoff || heights == DjiHeights::kGround;
  return serves ? number_in(folder, "globalHeight", where).value_or(kNaN) : kNaN;
}

std::vector<DjiWaypoint> waypoints_of(const XmlElement& folder, bool is_executed, DjiHeights heights,
                                      const std::string& folder_where) {
  std::vector<DjiWaypoint> waypoints;
  const double common_mps = speed_in(folder, "autoFlightSpeed", folder_where);
  for (const XmlElement& placemark : folder.children) {
    const XmlElement* point = placemark.name == "Placemark" ? placemark.child("Point") : nullptr;
    if (point == nullptr) continue;
    const int position = static_cast<int>(waypoints.size());
    std::string where = folder_where + ", waypoint " + std::to_string(position + 1);
    DjiWaypoint waypoint;
    waypoint.index = integer_in(placemark, "index", where).value_or(position);
    where = folder_where + ", waypoint of index " + std::to_string(waypoint.index);
    const std::vector<double> place = numbers_of(point->child_text("coordinates"), where + ": coordinates");
    if (place.size() < 2) throw DataError(where + ": its coordinates are not \"longitude,latitude\"");
    waypoint.point = checked_point(place[1], place[0], where);
    waypoint.height_m = checked_height_m(height_in(placemark, folder, is_executed, heights, where), where);
    const double own_mps = speed_in(placemark, "waypointSpeed", where);
    const bool as_all = placemark.child_text("useGlobalSpeed") == "1" || std::isnan(own_mps);
    waypoint.speed_mps = as_all ? common_mps : own_mps;
    take_turn(placemark, folder, where, waypoint);
    waypoints.push_back(waypoint);
    check_position_count(folder_where, waypoints.size());
  }
  std::stable_sort(waypoints.begin(), waypoints.end(),
                   [](const DjiWaypoint& a, const DjiWaypoint& b) { return a.index < b.index; });
  const auto twice = std::adjacent_find(waypoints.begin(), waypoints.end(),
                                        [](const DjiWaypoint& a, const DjiWaypoint& b) { return a.index == b.index; });
  if (twice != waypoints.end()) {
    throw DataError(folder_where + ": the waypoint index " + std::to_string(twice->index) + " stands twice");
  }
  return waypoints;
}

const XmlElement& document_of(const XmlElement& root, const std::string& name) {
  const XmlElement* document = root.child("Document");
  if (root.name == "kml" && document != nullptr) return *document;
  throw DataError(name + ": is no DJI mission: it has no kml/Document");
}

std::vector<DjiWayline> waylines_of(const XmlElement& document, const std::string& name, bool is_executed) {
  std::vector<DjiWayline> waylines;
  std::string type;
  for (const XmlElement& folder : document.children) {
    if (folder.name != "Folder") continue;
    const std::string where = name + ": wayline " + std::to_string(waylines.size() + 1);
    DjiWayline wayline;
    wayline.id =
        integer_in(folder, is_executed ? "waylineId" : "templateId", where).value_or(static_cast<int>(waylines.size()));
    if (is_executed) {
      wayline.height_mode = folder.child_text("executeHeightMode");
      wayline.heights = dji_heights(wayline.height_mode, where + ": its executeHeightMode");
    } else {
      type = folder.child_text("templateType");
      const XmlElement* system = folder.child("waylineCoordinateSysParam");
      wayline.height_mode = system == nullptr ? "" : system->child_text("heightMode");
      wayline.heights = dji_heights(wayline.height_mode, where + ": its heightMode");
    }
    wayline.waypoints = waypoints_of(folder, is_executed, wayline.heights, where);
    if (!wayline.waypoints.empty()) waylines.push_back(std::move(wayline));
  }
  if (waylines.empty() && !is_executed) {
    throw DataError(name + ": its template" + (type.empty() ? "" : " (" + type.substr(0, 40) + ")") +
                    " holds an area or settings and no path; save the mission as KMZ with wpmz/waylines.wpml, which "
                    "holds the path that is flown");
  }
  if (waylines.empty()) throw DataError(name + ": its waylines hold no waypoint");
  std::stable_sort(waylines.begin(), waylines.end(),
                   [](const DjiWayline& a, const DjiWayline& b) { return a.id < b.id; });
  return waylines;
}

/// Leaves the wayline that RouteOptions::feature numbers; the others are told in Route::items.
void choose_waylines(Route& route, std::vector<DjiWayline>& waylines, const RouteOptions& options) {
  if (options.feature.empty()) return;
  const auto number = parse_number(options.feature);
  const double count = static_cast<double>(waylines.size());
  if (!number || *number != std::floor(*number) || *number < 1 || *number > count) {
    throw DataError(route.name + ": has " + std::to_string(waylines.size()) + " waylines, numbered from 1; \"" +
                    options.feature + "\" is none of them");
  }
  const auto chosen = static_cast<std::size_t>(*number) - 1;
  const DjiWayline wayline = waylines[chosen];
  for (std::size_t i = 0; i < waylines.size(); ++i) {
    if (i != chosen) {
      route.items.push_back({static_cast<int>(i) + 1, -1, "wayline", "left out: another wayline was chosen"});
    }
  }
  waylines = {wayline};
}

/// The place of take-off that the template names for planning; its height is above the ellipsoid.
std::optional<RouteHome> reference_home(const XmlElement& mission_template, const std::string& name,
                                        const RouteOptions& options) {
  const XmlElement* config = mission_template.child("missionConfig");
  const std::string text = config == nullptr ? "" : config->child_text("takeOffRefPoint");
  if (text.empty()) return std::nullopt;
  const std::vector<double> place = numbers_of(text, name + ": takeOffRefPoint");
  if (place.size() != 3) throw DataError(name + ": takeOffRefPoint is not \"latitude,longitude,height\"");
  if (place[0] == 0 && place[1] == 0) return std::nullopt;
  RouteVertex vertex;
  vertex.point = checked_point(place[0], place[1], name + ": takeOffRefPoint");
  const double ellipsoid_m = checked_height_m(place[2], name + ": takeOffRefPoint");
  if (!options.agl_m) vertex.amsl_m = ellipsoid_m;  // else nothing is measured from it
  std::vector<RouteVertex> vertices = {vertex};
  bring_to_sea_level(name, vertices);
  return RouteHome{vertex.point, vertices.front().amsl_m};
}

/// Vertices of a wayline, heights where they belong.
std::vector<RouteVertex> vertices_of(Route& route, const DjiWayline& wayline, int item, const RouteOptions& options) {
  std::vector<RouteVertex> vertices;
  double lead_mps = wayline.waypoints.front().speed_mps;
  const double takeoff_amsl_m = options.home_amsl_m.value_or(route.home ? route.home->amsl_m : kNaN);
  std::size_t missing = 0;
  for (const DjiWaypoint& waypoint : wayline.waypoints) {
    RouteVertex vertex;
    vertex.point = waypoint.point;
    vertex.source_item = item;
    vertex.kind = "waypoint";
    vertex.speed_mps = lead_mps;
    lead_mps = waypoint.speed_mps;
    missing += std::isnan(waypoint.height_m) ? 1 : 0;
    if (wayline.heights == DjiHeights::kGround) {
      vertex.agl_m = waypoint.height_m;
    } else {
      vertex.amsl_m = waypoint.height_m + (wayline.heights == DjiHeights::kTakeoff ? takeoff_amsl_m : 0);
    }
    vertices.push_back(vertex);
  }
  if (options.agl_m) return vertices;  // apply_options sets it
  if (wayline.heights == DjiHeights::kEllipsoid) bring_to_sea_level(route.name, vertices);
  if (missing > 0) {
    add_note(route, std::to_string(missing) + " of " + std::to_string(vertices.size()) +
                        " waypoints have no height; give --agl-m.");
  }
  return vertices;
}

void note_heights(Route& route, const DjiWayline& wayline, const RouteOptions& options) {
  if (options.agl_m) return;
  switch (wayline.heights) {
    case DjiHeights::kEllipsoid:
      add_note(route,
               "Heights above the WGS 84 ellipsoid (executeHeightMode WGS84) were brought to sea level with the "
               "EGM96 geoid.");
      break;
    case DjiHeights::kSeaLevel:
      add_note(route, "Heights are above mean sea level (heightMode EGM96).");
      break;
    case DjiHeights::kGround:
      add_note(route,
               "Heights are above the ground (" + wayline.height_mode + "), which the aircraft is assumed to follow.");
      break;
    case DjiHeights::kTakeoff:
      add_takeoff_note(
          route, options,
          route.home && std::isfinite(route.home->amsl_m) ? "the take-off's reference point in the template" : "");
      break;
  }
}

void take_camera(Route& route, const XmlElement& document, const std::string& name) {
  const XmlElement* config = document.child("missionConfig");
  if (config == nullptr) return;
  std::vector<std::string> unknown;
  for (const XmlElement& payload : config->children) {
    if (payload.name != "payloadInfo") continue;
    const auto number = integer_in(payload, "payloadEnumValue", name + ": payloadInfo");
    if (!number) continue;
    const CameraProduct* product = dji_camera_product(*number);
    if (product == nullptr) {
      unknown.push_back(std::to_string(*number));
      continue;
    }
    route.camera = route_camera_of(*product);
    add_note(route, "The file names payload " + std::to_string(*number) + ", " + std::string(product->name) +
                        ": its whole wide photo, " + std::to_string(product->width_px) + " x " +
                        std::to_string(product->height_px) + " px, with a field of view of " +
                        format_fixed(horizontal_fov_deg(*product), 1) +
                        " degrees across, looking straight down, is taken for the camera.");
    return;
  }
  if (!unknown.empty()) {
    add_note(route, "The file names payload " + join(unknown, ", ") +
                        ", whose camera is not in the table of products; give the camera.");
  }
}

void note_turns(Route& route, const std::vector<DjiWayline>& waylines) {
  double widest_m = 0;
  std::size_t curves = 0;
  for (const DjiWayline& wayline : waylines) {
    const auto& points = wayline.waypoints;
    for (std::size_t i = 0; i < points.size(); ++i) curves += points[i].is_curve ? 1 : 0;
    for (std::size_t i = 1; i + 1 < points.size(); ++i) {
      widest_m = std::max(
          widest_m, corner_cut_m(points[i - 1].point, points[i].point, points[i + 1].point, points[i].turn_starts_m));
    }
  }
  add_corner_note(route, widest_m);
  if (curves > 0) {
    add_note(route, std::to_string(curves) +
                        " waypoints are flown along curves whose form DJI does not publish; "
                        "straight legs stand in for them.");
  }
}

void note_rest(Route& route, const XmlElement& document) {
  const XmlElement* config = document.child("missionConfig");
  const std::string finish = config == nullptr ? "" : config->child_text("finishAction");
  add_note(route, "The way from the take-off to the first waypoint" +
                      std::string(finish == "goHome" ? " and back home after the last" : "") +
                      " is not in the file and not part of the route" +
                      (finish.empty() ? "." : " (finishAction " + finish.substr(0, 40) + ")."));
}

}  // namespace

bool is_dji_wpml(std::string_view text) {
  return text.substr(0, 4096).find("://www.dji.com/wpmz") != std::string_view::npos;
}

Route parse_dji_wpml(const std::string& name, const std::string& format, std::string_view waylines_text,
                     std::string_view template_text, const RouteOptions& options) {
  const bool is_executed = !waylines_text.empty();
  const XmlElement root = parse_xml(name, is_executed ? waylines_text : template_text);
  const XmlElement& document = document_of(root, name);
  Route route;
  route.name = name;
  route.format = format;
  if (is_executed && !template_text.empty()) {
    const XmlElement template_root = parse_xml(name, template_text);
    route.home = reference_home(document_of(template_root, name), name, options);
  } else if (!is_executed) {
    route.home = reference_home(document, name, options);
    add_note(route, "The path is that of the template; the file holds no waylines.wpml, the path as it is flown.");
  }
  if (route.home && options.home_amsl_m) route.home->amsl_m = *options.home_amsl_m;
  std::vector<DjiWayline> waylines = waylines_of(document, name, is_executed);
  choose_waylines(route, waylines, options);
  const XmlElement* config = document.child("missionConfig");
  const double transit_mps = config == nullptr ? kNaN : speed_in(*config, "globalTransitionalSpeed", name);
  int last = -1;
  for (const DjiWayline& wayline : waylines) {
    const int item = static_cast<int>(&wayline - waylines.data()) + 1;
    std::vector<RouteVertex> vertices = vertices_of(route, wayline, item, options);
    if (last >= 0) vertices.front().speed_mps = transit_mps;
    for (const RouteVertex& vertex : vertices) {
      const int index = append_vertex(route, vertex);
      if (last >= 0 && index != last) append_leg(route, last, index);
      last = index;
    }
    note_heights(route, wayline, options);
    route.items.push_back(
        {item, -1, "wayline " + std::to_string(wayline.id), std::to_string(vertices.size()) + " waypoints"});
  }
  if (waylines.size() > 1) {
    add_note(route, "The " + std::to_string(waylines.size()) +
                        " waylines of the file are flown one after another, joined by straight legs; --feature NUMBER "
                        "chooses one, counted from 1.");
  }
  note_turns(route, waylines);
  take_camera(route, document, name);
  note_rest(route, document);
  apply_options(route, options);
  require_legs(route);
  return route;
}

}  // namespace pilotage
