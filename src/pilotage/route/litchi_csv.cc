#include "pilotage/route/litchi_csv.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "pilotage/base/csv.h"
#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/text.h"
#include "pilotage/base/utf8.h"
#include "pilotage/route/corner_cut.h"
#include "pilotage/route/route_builder.h"
#include "pilotage/route/route_size.h"
#include "pilotage/route/table_column.h"

namespace pilotage {
namespace {

constexpr double kFoot_m = 0.3048;
constexpr double kMilePerHour_mps = 0.44704;

struct LitchiColumns {
  TableColumn lat;
  TableColumn lon;
  TableColumn altitude;
  std::optional<TableColumn> mode;
  std::optional<TableColumn> speed;
  std::optional<TableColumn> curve;
  std::optional<TableColumn> gimbal;
};

std::optional<TableColumn> find_length(const std::vector<std::string>& columns, const std::string& key) {
  const auto metres = find_column(columns, key + "(m)", 1);
  return metres ? metres : find_column(columns, key + "(ft)", kFoot_m);
}

LitchiColumns litchi_columns(const std::string& name, const std::vector<std::string>& columns) {
  const auto lat = find_column(columns, "latitude", 1);
  const auto lon = find_column(columns, "longitude", 1);
  const auto altitude = find_length(columns, "altitude");
  if (!lat || !lon || !altitude) {
    std::vector<std::string> shown;
    for (std::size_t i = 0; i < columns.size() && i < 12; ++i) shown.push_back(columns[i].substr(0, 30));
    throw DataError(name +
                    ": is a table, and the tables known here are missions of Litchi, whose first row names the columns "
                    "latitude, longitude and altitude(m) or altitude(ft), separated by commas, and may name "
                    "altitudemode, speed(m/s) and curvesize(m), and those of UgCS, which name Latitude, Longitude and "
                    "AltitudeAMSL or AltitudeAGL; this one has " +
                    join(shown, ", ") + (columns.size() > shown.size() ? ", …" : "") +
                    ". Name the columns so, or save the route as KML, GPX or GeoJSON");
  }
  LitchiColumns found{*lat, *lon, *altitude, {}, {}, {}, {}};
  found.mode = find_column(columns, "altitudemode", 1);
  found.speed = find_column(columns, "speed(m/s)", 1);
  if (!found.speed) found.speed = find_column(columns, "speed(mph)", kMilePerHour_mps);
  found.curve = find_length(columns, "curvesize");
  found.gimbal = find_column(columns, "gimbalpitchangle", 1);
  return found;
}

/// What the rows need to be told about together.
struct LitchiNotes {
  std::size_t above_takeoff = 0;
  std::size_t above_ground = 0;
  std::size_t without_speed = 0;
  std::size_t not_down = 0;
};

void add_litchi_notes(Route& route, const LitchiNotes& notes, std::size_t waypoints, const RouteOptions& options) {
  if (notes.above_takeoff > 0) add_takeoff_note(route, options, "");
  if (notes.above_ground > 0 && !options.agl_m) {
    add_note(route,
             "Heights of " + std::to_string(notes.above_ground) + " of " + std::to_string(waypoints) +
                 " waypoints are above the ground (altitudemode 1). Litchi keeps them at the waypoints and flies "
                 "straight between; here the ground between them is followed.");
  }
  if (notes.without_speed > 0 && !options.speed_mps) {
    add_note(route, std::to_string(notes.without_speed) +
                        " waypoints have speed 0, the mission's cruising speed, which the file does not hold; give "
                        "--speed-mps.");
  }
  if (notes.not_down > 0) {
    add_note(route, "At " + std::to_string(notes.not_down) + " of " + std::to_string(waypoints) +
                        " waypoints the gimbal does not look straight down; the camera is taken to look down, or as "
                        "the mount of the options says.");
  }
}

}  // namespace

bool is_table(std::string_view text) {
  text = without_byte_order_mark(text);
  const std::string_view line = text.substr(0, text.find_first_of("\r\n"));
  if (line.empty() || line.size() > 8192) return false;
  const bool is_text =
      std::none_of(line.begin(), line.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 && c != '\t'; });
  return is_text && line.find_first_of(",;\t") != std::string_view::npos;
}

Route parse_litchi_csv(const std::string& name, std::string_view text, const RouteOptions& options) {
  check_position_count(name, static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')));
  CsvTable table(name, text, "a mission of Litchi");
  const LitchiColumns columns = litchi_columns(name, table.columns());
  Route route;
  route.name = name;
  route.format = "Litchi CSV";
  LitchiNotes notes;
  std::vector<double> turns_m;  // of each row
  std::vector<GeodeticPoint> points;
  double lead_mps = kNaN;
  while (const std::vector<std::string>* cells = table.next()) {
    const std::string where = table.where();
    const auto number = [&](const TableColumn& column) { return cell_number(*cells, column, table.columns(), where); };
    const auto number_or = [&](const std::optional<TableColumn>& column, double otherwise) {
      return column ? number(*column) : otherwise;
    };
    RouteVertex vertex;
    vertex.point = checked_point(number(columns.lat), number(columns.lon), where.substr(0, where.size() - 2));
    const double height_m = checked_height_m(number(columns.altitude), where.substr(0, where.size() - 2));
    const double mode = number_or(columns.mode, 0);
    if (mode != 0 && mode != 1) {
      throw DataError(where + "altitudemode = " + format_number(mode) +
                      "; known are 0 (above the take-off) and 1 (above the ground)");
    }
    if (mode == 1) vertex.agl_m = height_m;
    if (mode == 0) vertex.amsl_m = height_m + options.home_amsl_m.value_or(kNaN);
    ++(mode == 1 ? notes.above_ground : notes.above_takeoff);
    const double speed_mps = number_or(columns.speed, 0);
    if (speed_mps < 0 || speed_mps > 1000) {
      throw DataError(where + "its speed, " + format_number(speed_mps) + " m/s, is outside [0, 1000]");
    }
    const double own_mps = speed_mps > 0 ? speed_mps : kNaN;
    vertex.speed_mps = points.empty() ? own_mps : lead_mps;
    lead_mps = own_mps;
    notes.without_speed += std::isnan(own_mps) ? 1 : 0;
    notes.not_down += columns.gimbal && number(*columns.gimbal) > -89.5 ? 1 : 0;
    turns_m.push_back(number_or(columns.curve, 0));
    points.push_back(vertex.point);
    append_waypoint(route, vertex);
  }
  double widest_m = 0;
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    widest_m = std::max(widest_m, corner_cut_m(points[i - 1], points[i], points[i + 1], turns_m[i]));
  }
  add_litchi_notes(route, notes, points.size(), options);
  add_corner_note(route, widest_m);
  apply_options(route, options);
  require_legs(route);
  return route;
}

}  // namespace pilotage
