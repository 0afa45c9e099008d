#include "pilotage/route/qgc_wpl.h"

#include <array>
#include <cmath>
#include <vector>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/base/utf8.h"
#include "pilotage/route/mission_command.h"
#include "pilotage/route/mission_items.h"
#include "pilotage/route/route_builder.h"

namespace pilotage {
namespace {

constexpr std::string_view kBlanks = " \t\r\v\f";

std::vector<std::string_view> split_fields(std::string_view line) {
  std::vector<std::string_view> fields;
  for (std::size_t begin = line.find_first_not_of(kBlanks); begin != std::string_view::npos;) {
    const std::size_t end = line.find_first_of(kBlanks, begin);
    fields.push_back(line.substr(begin, end == std::string_view::npos ? end : end - begin));
    begin = end == std::string_view::npos ? end : line.find_first_not_of(kBlanks, end);
  }
  return fields;
}

double field_number(std::string_view field, const std::string& where, std::size_t column) {
  const auto number = parse_number(field);
  if (!number || !std::isfinite(*number)) {
    throw DataError(where + ": field " + std::to_string(column + 1) + " is \"" + std::string(field.substr(0, 40)) +
                    "\", expected a finite number");
  }
  return *number;
}

int field_integer(std::string_view field, const std::string& where, std::size_t column) {
  const double number = field_number(field, where, column);
  if (number != std::floor(number) || number < 0 || number > 1e6) {
    throw DataError(where + ": field " + std::to_string(column + 1) + " is \"" + std::string(field.substr(0, 40)) +
                    "\", expected an integer of 0 or more");
  }
  return static_cast<int>(number);
}

MissionItem parse_row(std::string_view line, const std::string& where) {
  const auto fields = split_fields(line);
  if (fields.size() != 12) {
    throw DataError(where + ": has " + std::to_string(fields.size()) + " fields, expected 12");
  }
  MissionItem item;
  item.index = item.sequence = field_integer(fields[0], where, 0);
  item.frame = field_integer(fields[2], where, 2);
  item.command = field_integer(fields[3], where, 3);
  for (std::size_t i = 0; i < item.params.size(); ++i) item.params[i] = field_number(fields[i + 4], where, i + 4);
  return item;
}

std::vector<MissionItem> parse_rows(const std::string& name, std::string_view text) {
  std::vector<MissionItem> items;
  std::size_t line_number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = text.find('\n', begin);
    const std::string_view line = text.substr(begin, end == std::string_view::npos ? end : end - begin);
    begin = end == std::string_view::npos ? text.size() : end + 1;
    if (++line_number == 1) continue;
    const auto first = line.find_first_not_of(kBlanks);
    if (first == std::string_view::npos || line[first] == '#') continue;
    const std::string where = name + ": line " + std::to_string(line_number);
    const MissionItem item = parse_row(line, where);
    if (!items.empty() && item.index <= items.back().index) {
      throw DataError(where + ": item number " + std::to_string(item.index) + " does not follow " +
                      std::to_string(items.back().index));
    }
    items.push_back(item);
  }
  return items;
}

/// Takes home from row 0 and, if it is a pure home row, the row itself.
void take_home(Route& route, MavlinkMission& mission) {
  if (mission.items.empty() || mission.items.front().index != 0) {
    add_note(route, "The file has no row 0, so it names no home.");
    return;
  }
  const MissionItem row = mission.items.front();
  const bool is_home_row = row.command == 16 && (row.frame == 0 || row.frame == 5);
  const bool has_place = row.params[4] != 0 || row.params[5] != 0;
  if (has_place) {
    const GeodeticPoint place = checked_point(row.params[4], row.params[5], route.name + ": item 0 (home)");
    mission.home = RouteHome{place};
    if (is_home_row) mission.home->amsl_m = checked_height_m(row.params[6], route.name + ": item 0 (home)");
  }
  if (is_home_row) {
    route.items.push_back({0, row.command, "home", has_place ? "home" : "left out: lat = lon = 0, no home is set"});
    mission.items.erase(mission.items.begin());
  } else {
    add_note(route, "Row 0 is no home row (a waypoint above sea level) but a " + mission_command_name(row.command) +
                        " in frame " + std::to_string(row.frame) +
                        ": it is flown, and its place stands in for home, whose height is not known.");
  }
}

}  // namespace

bool is_qgc_wpl(std::string_view text) {
  return without_byte_order_mark(text).starts_with("QGC WPL");
}

Route parse_qgc_wpl(const std::string& name, std::string_view text, const RouteOptions& options) {
  text = without_byte_order_mark(text);
  const auto header = split_fields(text.substr(0, text.find('\n')));
  if (header.size() != 3 || header[0] != "QGC" || header[1] != "WPL" || header[2] != "110") {
    throw DataError(name + ": the first line is not \"QGC WPL 110\"; other versions are not supported");
  }
  Route route;
  route.name = name;
  route.format = "QGC WPL 110";
  MavlinkMission mission;
  mission.items = parse_rows(name, text);
  if (mission.items.empty()) throw DataError(name + ": has no items");
  take_home(route, mission);
  append_mission(route, mission, options);
  apply_options(route, options);
  require_legs(route);
  return route;
}

}  // namespace pilotage
