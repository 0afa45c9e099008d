#include "pilotage/route/ugcs_csv.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "pilotage/base/csv.h"
#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/text.h"
#include "pilotage/base/utf8.h"
#include "pilotage/route/route_builder.h"
#include "pilotage/route/route_size.h"
#include "pilotage/route/table_column.h"

namespace pilotage {
namespace {

struct UgcsColumns {
  TableColumn lat;
  TableColumn lon;
  std::optional<TableColumn> amsl;
  std::optional<TableColumn> agl;
  std::optional<TableColumn> speed;
};

UgcsColumns ugcs_columns(const std::string& name, const std::vector<std::string>& columns) {
  const auto lat = find_column(columns, "latitude", 1);
  const auto lon = find_column(columns, "longitude", 1);
  std::vector<std::string> missing;
  if (!lat) missing.emplace_back("Latitude");
  if (!lon) missing.emplace_back("Longitude");
  if (!missing.empty()) {
    throw DataError(name + ": is a table with the heights of UgCS and no column " + join(missing, ", ") +
                    "; needed are Latitude and Longitude in degrees, and AltitudeAMSL or AltitudeAGL in metres");
  }
  return {*lat, *lon, find_column(columns, "altitudeamsl", 1), find_column(columns, "altitudeagl", 1),
          find_column(columns, "speed", 1)};
}

}  // namespace

bool is_ugcs_table(std::string_view text) {
  text = without_byte_order_mark(text);
  std::vector<std::string> columns;
  try {
    CsvReader reader("", text.substr(0, text.find('\n')));
    if (!reader.next(columns)) return false;
  } catch (const DataError&) {
    return false;  // whoever reads it says what is wrong with it
  }
  return find_column(columns, "altitudeamsl", 1) || find_column(columns, "altitudeagl", 1);
}

Route parse_ugcs_csv(const std::string& name, std::string_view text, const RouteOptions& options) {
  check_position_count(name, static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')));
  CsvTable table(name, text, "waypoints of UgCS");
  const UgcsColumns columns = ugcs_columns(name, table.columns());
  Route route;
  route.name = name;
  route.format = "UgCS CSV";
  std::vector<double> speeds_mps;
  std::size_t with_both = 0;
  while (const std::vector<std::string>* cells = table.next()) {
    const std::string where = table.where();
    const std::string place = where.substr(0, where.size() - 2);
    const auto number = [&](const std::optional<TableColumn>& column) -> std::optional<double> {
      return column ? cell_number_if_any(*cells, *column, table.columns(), where) : std::nullopt;
    };
    RouteVertex vertex;
    vertex.point = checked_point(cell_number(*cells, columns.lat, table.columns(), where),
                                 cell_number(*cells, columns.lon, table.columns(), where), place);
    const auto amsl_m = number(columns.amsl);
    const auto agl_m = number(columns.agl);
    if (!amsl_m && !agl_m) throw DataError(where + "has neither AltitudeAMSL nor AltitudeAGL");
    with_both += amsl_m && agl_m ? 1 : 0;
    (amsl_m ? vertex.amsl_m : vertex.agl_m) = checked_height_m(amsl_m ? *amsl_m : *agl_m, place);
    vertex.speed_mps = number(columns.speed).value_or(kNaN);
    if (vertex.speed_mps <= 0 || vertex.speed_mps > 1000) {
      throw DataError(where + "its Speed, " + format_number(vertex.speed_mps) + " m/s, is outside (0, 1000]");
    }
    speeds_mps.push_back(vertex.speed_mps);
    append_waypoint(route, vertex);
  }
  if (with_both > 0 && !options.agl_m) {
    add_note(route, std::to_string(with_both) + " of " + std::to_string(route.items.size()) +
                        " waypoints have AltitudeAMSL and AltitudeAGL; the one above sea level is taken.");
  }
  const auto other_speed = [&](double speed_mps) { return speed_mps != speeds_mps.front() && speed_mps > 0; };
  if (!options.speed_mps && std::any_of(speeds_mps.begin(), speeds_mps.end(), other_speed)) {
    add_note(route, "The speeds of the waypoints differ; each is taken as that of the way to its waypoint.");
  }
  apply_options(route, options);
  require_legs(route);
  return route;
}

}  // namespace pilotage
