#include "pilotage/route/dji_wpml_writer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/camera/camera_products.h"
#include "pilotage/raster/gdal_zip.h"
#include "pilotage/route/ogr_route.h"
#include "pilotage/route/qgc_plan_writer.h"

namespace pilotage {
namespace {

constexpr double kMaxTransitional_mps = 15;  // of globalTransitionalSpeed

// Aircraft whose payload is their own, by DJI's numbers (Common Elements: droneInfo, payloadInfo).
struct DjiAircraft {
  int payload = 0;
  int drone = 0;
  int sub_drone = 0;
};
constexpr std::array<DjiAircraft, 6> kAircraft = {
    {{52, 67, 0}, {53, 67, 1}, {66, 77, 0}, {67, 77, 1}, {68, 77, 2}, {80, 91, 0}}};

std::optional<DjiAircraft> aircraft_of(const std::string& camera) {
  for (const CameraProduct& product : camera_products()) {
    if (camera != product.name || product.dji_payload < 0) continue;
    for (const DjiAircraft& aircraft : kAircraft) {
      if (aircraft.payload == product.dji_payload) return aircraft;
    }
  }
  return std::nullopt;
}

std::string element(const std::string& name, const std::string& text) {
  return "<wpml:" + name + ">" + text + "</wpml:" + name + ">\n";
}

std::string element(const std::string& name, int number) {
  return element(name, std::to_string(number));
}

std::string metres(double value) {
  return format_fixed(value, 3);
}

// The vertices in the order of flight; where the route climbs over a place, both of its vertices.
std::vector<RouteVertex> flown_vertices(const Route& route) {
  require_one_line(route);
  std::vector<RouteVertex> flown;
  for (std::size_t i = 0; i < route.legs.size(); ++i) {
    const RouteLeg& leg = route.legs[i];
    if (i == 0 || leg.from != route.legs[i - 1].to) flown.push_back(route.vertices[static_cast<std::size_t>(leg.from)]);
    flown.push_back(route.vertices[static_cast<std::size_t>(leg.to)]);
  }
  while (!flown.empty() && flown.back().on_ground) flown.pop_back();
  const bool lands =
      std::any_of(flown.begin(), flown.end(), [](const RouteVertex& vertex) { return vertex.on_ground; });
  if (lands) throw DataError(route.name + ": lands on its way, which a DJI mission cannot");
  if (flown.size() < 2) throw DataError(route.name + ": has no two waypoints above the ground for a DJI mission");
  return flown;
}

// Waypoints as the documents have them.
struct FlownWaypoint {
  GeodeticPoint point;
  double height_m = 0;    ///< Of the template: above sea level, or above the ground.
  double executed_m = 0;  ///< Of the waylines: above the ellipsoid, or above the ground.
  double speed_mps = 0;   ///< To the next one.
};

bool follows_ground(const std::string& name, const std::vector<RouteVertex>& flown) {
  const auto above_ground =
      std::count_if(flown.begin(), flown.end(), [](const RouteVertex& vertex) { return std::isfinite(vertex.agl_m); });
  if (above_ground != 0 && above_ground != std::ssize(flown)) {
    throw DataError(name +
                    ": has heights above the ground at some waypoints and above the sea at others; a DJI mission has "
                    "one kind");
  }
  return above_ground != 0;
}

// By how much the ellipsoid's heights are larger than those above the sea.
std::vector<double> geoid_heights_m(const std::string& name, std::vector<RouteVertex> vertices) {
  for (RouteVertex& vertex : vertices) vertex.amsl_m = 0;
  bring_to_sea_level(name, vertices);
  std::vector<double> heights_m;
  heights_m.reserve(vertices.size());
  for (const RouteVertex& vertex : vertices) heights_m.push_back(-vertex.amsl_m);
  return heights_m;
}

std::vector<FlownWaypoint> flown_waypoints(const std::string& name, const std::vector<RouteVertex>& flown,
                                           bool over_ground) {
  std::vector<double> geoid_m(flown.size(), 0);
  if (!over_ground) geoid_m = geoid_heights_m(name, flown);
  std::vector<FlownWaypoint> waypoints;
  for (std::size_t i = 0; i < flown.size(); ++i) {
    FlownWaypoint waypoint;
    waypoint.point = flown[i].point;
    waypoint.height_m = over_ground ? flown[i].agl_m : flown[i].amsl_m;
    waypoint.executed_m = waypoint.height_m + geoid_m[i];
    waypoint.speed_mps = flown[std::min(i + 1, flown.size() - 1)].speed_mps;
    const std::string where = name + ": waypoint " + std::to_string(i + 1);
    if (!std::isfinite(waypoint.height_m)) throw DataError(where + " has no height, which a DJI mission needs");
    if (!std::isfinite(waypoint.speed_mps)) throw DataError(where + " has no speed, which a DJI mission needs");
    waypoints.push_back(waypoint);
  }
  return waypoints;
}

std::string mission_config(const std::vector<FlownWaypoint>& waypoints, const std::optional<DjiAircraft>& aircraft,
                           const std::string& reference_point) {
  std::string text =
      "<wpml:missionConfig>\n" + element("flyToWaylineMode", "safely") + element("finishAction", "goHome") +
      element("exitOnRCLost", "executeLostAction") + element("executeRCLostAction", "goBack") +
      element("takeOffSecurityHeight", 20) + reference_point +
      element("globalTransitionalSpeed", format_number(std::min(waypoints.front().speed_mps, kMaxTransitional_mps)));
  if (aircraft) {
    text += "<wpml:droneInfo>\n" + element("droneEnumValue", aircraft->drone) +
            element("droneSubEnumValue", aircraft->sub_drone) + "</wpml:droneInfo>\n<wpml:payloadInfo>\n" +
            element("payloadEnumValue", aircraft->payload) + element("payloadPositionIndex", 0) +
            "</wpml:payloadInfo>\n";
  }
  return text + "</wpml:missionConfig>\n";
}

std::string document(const std::string& inside) {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<kml xmlns=\"http://www.opengis.net/kml/2.2\" "
         "xmlns:wpml=\"http://www.dji.com/wpmz/1.0.2\">\n<Document>\n" +
         inside + "</Document>\n</kml>\n";
}

std::string heading(const std::string& name) {
  return "<wpml:" + name + ">\n" + element("waypointHeadingMode", "followWayline") +
         element("waypointHeadingPathMode", "followBadArc") + "</wpml:" + name + ">\n";
}

constexpr const char* kTurnMode = "toPointAndStopWithDiscontinuityCurvature";

std::string placemark(int index, const FlownWaypoint& waypoint, const std::string& inside) {
  return "<Placemark>\n<Point><coordinates>" + format_fixed(waypoint.point.lon_deg, 9) + "," +
         format_fixed(waypoint.point.lat_deg, 9) + "</coordinates></Point>\n" + element("index", index) + inside +
         element("waypointSpeed", format_number(waypoint.speed_mps)) + "</Placemark>\n";
}

std::string template_folder(const std::vector<FlownWaypoint>& waypoints, bool over_ground) {
  std::string text = "<Folder>\n" + element("templateType", "waypoint") + element("templateId", 0) +
                     "<wpml:waylineCoordinateSysParam>\n" + element("coordinateMode", "WGS84") +
                     element("heightMode", over_ground ? "aboveGroundLevel" : "EGM96") +
                     element("positioningType", "GPS") + "</wpml:waylineCoordinateSysParam>\n" +
                     element("autoFlightSpeed", format_number(waypoints.front().speed_mps)) +
                     element("globalHeight", metres(waypoints.front().height_m)) +
                     element("gimbalPitchMode", "manual") + heading("globalWaypointHeadingParam") +
                     element("globalWaypointTurnMode", kTurnMode) + element("globalUseStraightLine", 1);
  int index = 0;
  for (const FlownWaypoint& waypoint : waypoints) {
    text += placemark(index++, waypoint,
                      element("ellipsoidHeight", metres(waypoint.executed_m)) +
                          element("height", metres(waypoint.height_m)) + element("useGlobalHeight", 0) +
                          element("useGlobalSpeed", 0) + element("useGlobalHeadingParam", 1) +
                          element("useGlobalTurnParam", 1));
  }
  return text + "</Folder>\n";
}

std::string wayline_folder(const std::vector<FlownWaypoint>& waypoints, bool over_ground) {
  std::string text = "<Folder>\n" + element("templateId", 0) +
                     element("executeHeightMode", over_ground ? "realTimeFollowSurface" : "WGS84") +
                     element("waylineId", 0) + element("autoFlightSpeed", format_number(waypoints.front().speed_mps));
  int index = 0;
  for (const FlownWaypoint& waypoint : waypoints) {
    text += placemark(index++, waypoint,
                      element("executeHeight", metres(waypoint.executed_m)) + heading("waypointHeadingParam") +
                          "<wpml:waypointTurnParam>\n" + element("waypointTurnMode", kTurnMode) +
                          element("waypointTurnDampingDist", 0) + "</wpml:waypointTurnParam>\n" +
                          element("useStraightLine", 1));
  }
  return text + "</Folder>\n";
}

// The planned place of take-off, for DJI's programs to show; its height is above the ellipsoid.
std::string take_off_reference(const Route& route) {
  if (!route.home || !std::isfinite(route.home->amsl_m)) return "";
  RouteVertex home;
  home.point = route.home->point;
  const double ellipsoid_m = route.home->amsl_m + geoid_heights_m(route.name, {home}).front();
  return element("takeOffRefPoint", format_fixed(home.point.lat_deg, 9) + "," + format_fixed(home.point.lon_deg, 9) +
                                        "," + metres(ellipsoid_m));
}

}  // namespace

DjiMission dji_mission_of(const Route& route, const std::string& camera) {
  const std::vector<RouteVertex> flown = flown_vertices(route);
  const bool over_ground = follows_ground(route.name, flown);
  const std::vector<FlownWaypoint> waypoints = flown_waypoints(route.name, flown, over_ground);
  const std::optional<DjiAircraft> aircraft = aircraft_of(camera);
  return {document(mission_config(waypoints, aircraft, take_off_reference(route)) +
                   template_folder(waypoints, over_ground)),
          document(mission_config(waypoints, aircraft, "") + wayline_folder(waypoints, over_ground))};
}

std::string camera_product_of(const std::string& named, const Route& route) {
  if (!named.empty()) return std::string(camera_product(named).name);
  return route.camera ? route.camera->name : "";
}

void write_dji_mission(const std::filesystem::path& path, const DjiMission& mission, bool overwrite) {
  write_zip(path, {{"wpmz/template.kml", mission.mission_template}, {"wpmz/waylines.wpml", mission.waylines}},
            overwrite);
}

}  // namespace pilotage
