#include "pilotage/route/mission_items.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/text.h"
#include "pilotage/geo/geodesic.h"
#include "pilotage/route/mission_command.h"
#include "pilotage/route/mission_curve.h"
#include "pilotage/route/route_builder.h"

namespace pilotage {
namespace {

enum class AltitudeFrame { kAmsl, kRelative, kTerrain };

/// More than any autopilot stores, and few enough to follow every jump.
constexpr std::size_t kMaxSteps = 2'000'000;
/// A takeoff within this distance of home happens at home.
constexpr double kAtHome_m = 1;
constexpr int kSplineWaypoint = 82;
/// Circles of loiters; smaller ones are hovering, larger ones a mistake.
constexpr double kSmallestCircle_m = 1;
constexpr double kLargestCircle_m = 20'000;

/// Where the aircraft is while the items are followed.
struct Cursor {
  std::size_t item = 0;
  int vertex = -1;
  double speed_mps = kNaN;
  /// The way it came to its vertex without stopping, which a spline that leaves there goes on from: the last straight
  /// leg, or the end vector of the last spline.
  GroundVector came{};
  /// What a height of 0 keeps.
  double kept_amsl_m = kNaN;
  double kept_agl_m = kNaN;

  void keep_height_of(const RouteVertex& place) {
    kept_amsl_m = place.amsl_m;
    kept_agl_m = place.agl_m;
  }
  bool keeps_height() const { return std::isfinite(kept_amsl_m) || std::isfinite(kept_agl_m); }
};

/// The state of following a mission; lives for one call of append_mission.
struct Follower {
  Route& route;
  const MavlinkMission& mission;
  const RouteOptions& options;
  std::map<int, std::size_t> item_of_sequence{};
  std::map<int, std::size_t> item_of_tag{};
  std::vector<int> vertex_of_item{};  ///< -1: none yet.
  std::vector<std::string> became{};  ///< Per mission item; empty: not reached.
  std::set<std::pair<int, int>> legs{};
  std::set<std::pair<std::size_t, int>> visited{};
  std::vector<Cursor> open{};              ///< Ways still to follow, last first.
  double widest_spline_m = 0;              ///< Largest distance of a spline from its straight leg.
  std::vector<std::size_t> kept_height{};  ///< Items whose height of 0 keeps the one before.
};

std::string where(const Follower& follower, const MissionItem& item) {
  return follower.route.name + ": item " + std::to_string(item.index) + " (" + mission_command_name(item.command) + ")";
}

bool has_position(const Follower& follower, const MissionItem& item) {
  const double lat = item.params[4];
  const double lon = item.params[5];
  if (lat == 0 && lon == 0) return false;
  if (std::isnan(lat) && std::isnan(lon)) {
    if (command_info(item.command).role != CommandRole::kPath || (item.command >= 17 && item.command <= 19))
      return false;
    throw DataError(where(follower, item) + ": has no latitude and longitude (null)");
  }
  return true;
}

AltitudeFrame altitude_frame(const Follower& follower, const MissionItem& item) {
  switch (item.frame) {
    case 0:
    case 5:
      return AltitudeFrame::kAmsl;
    case 3:
    case 6:
      return AltitudeFrame::kRelative;
    case 10:
    case 11:
      return AltitudeFrame::kTerrain;
    default:
      throw DataError(where(follower, item) + ": coordinate frame " + std::to_string(item.frame) +
                      " is not supported; allowed are 0, 5 (sea level), 3, 6 (home) and 10, 11 (terrain)");
  }
}

void set_height(const Follower& follower, const MissionItem& item, RouteVertex& vertex) {
  const AltitudeFrame frame = altitude_frame(follower, item);
  if (follower.options.agl_m) return;  // apply_options sets it
  const double altitude_m = item.params[6];
  if (!std::isfinite(altitude_m)) {
    throw DataError(where(follower, item) + ": has no altitude; give --agl-m to fly at a constant height above ground");
  }
  switch (frame) {
    case AltitudeFrame::kAmsl:
      vertex.amsl_m = altitude_m;
      break;
    case AltitudeFrame::kTerrain:
      vertex.agl_m = altitude_m;
      break;
    case AltitudeFrame::kRelative: {
      const double home_m =
          follower.options.home_amsl_m.value_or(follower.mission.home ? follower.mission.home->amsl_m : kNaN);
      if (!std::isfinite(home_m)) {
        throw DataError(
            where(follower, item) + ": its altitude " + format_number(altitude_m) +
            " m is relative to home, but the file does not say home's height; give --home-amsl-m or --agl-m");
      }
      vertex.amsl_m = home_m + altitude_m;
      break;
    }
  }
  checked_height_m(vertex.amsl_m, where(follower, item));
  checked_height_m(vertex.agl_m, where(follower, item));
}

std::string height_text(double amsl_m, double agl_m) {
  return std::isfinite(amsl_m) ? format_fixed(amsl_m, 1) + " m above sea level"
                               : format_fixed(agl_m, 1) + " m above ground";
}

/// A height of 0 of a place that is flown to: "keep the height" to ArduPilot.
bool keeps_height_before(const Follower& follower, const Cursor& cursor, const MissionItem& item) {
  return command_info(item.command).role == CommandRole::kPath && item.params[6] == 0 && !follower.options.agl_m &&
         !follower.mission.is_px4 && cursor.keeps_height();
}

GeodeticPoint place_of(const Follower& follower, int vertex) {
  return follower.route.vertices[static_cast<std::size_t>(vertex)].point;
}

void fly_to(Follower& follower, Cursor& cursor, int vertex) {
  if (cursor.vertex >= 0 && cursor.vertex != vertex) {
    if (follower.legs.emplace(cursor.vertex, vertex).second) append_leg(follower.route, cursor.vertex, vertex);
    cursor.came = arriving_vector(place_of(follower, cursor.vertex), place_of(follower, vertex));
  }
  cursor.vertex = vertex;
}

/// The item that is flown to after that of the cursor, as an autopilot looks ahead: over items without a place, and
/// with the first jump that is taken. Nothing where none has a position.
const MissionItem* next_place(const Follower& follower, const Cursor& cursor) {
  const auto& items = follower.mission.items;
  bool jumped = false;
  for (std::size_t i = cursor.item + 1; i < items.size();) {
    const CommandRole role = command_info(items[i].command).role;
    if (role == CommandRole::kReturn) return nullptr;
    if (role == CommandRole::kPath || role == CommandRole::kTakeoff || role == CommandRole::kLand) {
      return has_position(follower, items[i]) ? &items[i] : nullptr;
    }
    const auto target = follower.item_of_sequence.find(
        role == CommandRole::kJump && std::abs(items[i].params[0]) < 1e9 ? static_cast<int>(items[i].params[0]) : -1);
    const bool jumps =
        role == CommandRole::kJump && !jumped && items[i].params[1] != 0 && target != follower.item_of_sequence.end();
    jumped = jumped || jumps;
    i = jumps ? target->second : i + 1;
  }
  return nullptr;
}

/// Chords of the spline from where the cursor is to `target`, which ends with the vertex `known` where that is one; the
/// vertex it ends with.
int fly_spline(Follower& follower, Cursor& cursor, const RouteVertex& target, int known) {
  const RouteVertex start = follower.route.vertices[static_cast<std::size_t>(cursor.vertex)];
  GroundVector arriving;
  if (const MissionItem* next = next_place(follower, cursor)) {
    const GeodeticPoint place = checked_point(next->params[4], next->params[5], where(follower, *next));
    arriving =
        next->command == kSplineWaypoint ? ground_vector(start.point, place) : ground_vector(target.point, place);
  }
  const GroundVector leaving = cursor.came;
  cursor.came = arriving;
  if (known >= 0 && !follower.legs.emplace(cursor.vertex, known).second) return known;
  double departure_m = 0;
  const auto points = spline_points(start.point, target.point, leaving, arriving, &departure_m);
  if (!points.empty()) follower.widest_spline_m = std::max(follower.widest_spline_m, departure_m);
  int last = cursor.vertex;
  for (const CurvePoint& point : points) {
    RouteVertex between = target;
    between.point = point.point;
    for (double RouteVertex::*height : {&RouteVertex::amsl_m, &RouteVertex::agl_m}) {
      if (std::isfinite(start.*height)) {
        between.*height = start.*height + point.fraction * (target.*height - start.*height);
      }
    }
    const int index = append_vertex(follower.route, between);
    if (index != last) append_leg(follower.route, last, index);
    last = index;
  }
  const int end = known >= 0 ? known : append_vertex(follower.route, target);
  if (known < 0) follower.legs.emplace(cursor.vertex, end);
  if (end != last) append_leg(follower.route, last, end);
  return end;
}

/// The radius of the circle that a loiter flies, negative counter-clockwise; nothing where it flies none.
std::optional<double> circle_radius_m(Follower& follower, const MissionItem& item) {
  const bool turns = item.command == 18;
  const bool may_hover = item.command == 17 || item.command == 19;
  if (!item.kind.empty() || !(turns || may_hover || item.command == 31)) return std::nullopt;
  if (may_hover && follower.mission.hovers) return std::nullopt;
  const double radius_m = item.params[item.command == 31 ? 1 : 2];
  if (std::isnan(radius_m) || radius_m == 0) {
    add_note(follower.route, "Item " + std::to_string(item.index) + " (" + mission_command_name(item.command) +
                                 ") names no radius: a circle there has that of the vehicle's parameters, which is not "
                                 "in the file, and is not part of the route.");
    return std::nullopt;
  }
  if (std::abs(radius_m) < kSmallestCircle_m) return std::nullopt;
  if (std::abs(radius_m) <= kLargestCircle_m) return radius_m;
  throw DataError(where(follower, item) + ": its radius, " + format_number(radius_m) + " m, is outside [-" +
                  format_number(kLargestCircle_m) + ", " + format_number(kLargestCircle_m) + "]");
}

/// To the circle about the place of `on_circle`, where it is nearest, and once around; the vertex of entry and exit.
int fly_circle(Follower& follower, Cursor& cursor, RouteVertex on_circle, double radius_m) {
  const GeodeticPoint center = on_circle.point;
  double entry_deg = 0;
  if (cursor.vertex >= 0) entry_deg = geodesic_between(center, place_of(follower, cursor.vertex)).start_azimuth_deg;
  int entry = -1;
  int last = -1;
  for (const GeodeticPoint point : circle_points(center, std::abs(radius_m), entry_deg, radius_m > 0)) {
    on_circle.point = point;
    const int index = append_vertex(follower.route, on_circle);
    if (entry < 0) {
      entry = index;
      fly_to(follower, cursor, entry);
    } else if (index != last) {
      append_leg(follower.route, last, index);
    }
    last = index;
  }
  append_leg(follower.route, last, entry);
  cursor.came = {};
  add_note(follower.route,
           "Circles of loiters stand once, whatever their turns or time, as chords that leave them by " +
               format_number(kChordError_m) +
               " m at most; the aircraft is assumed to enter and leave each at the point "
               "nearest to where it comes from.");
  return entry;
}

/// As the item of the cursor says, straight or along a spline, to `target`, whose vertex is `known` where it has one.
void fly_item_to(Follower& follower, Cursor& cursor, const RouteVertex& target, int& known) {
  const MissionItem& item = follower.mission.items[cursor.item];
  if (item.command == kSplineWaypoint && cursor.vertex >= 0) {
    known = fly_spline(follower, cursor, target, known);
    cursor.vertex = known;
    return;
  }
  if (known < 0) known = append_vertex(follower.route, target);
  fly_to(follower, cursor, known);
  // The aircraft stands still there, so that a spline begins without an end vector.
  if (item.command != 16 || item.params[0] > 0) cursor.came = {};
}

/// The vertex of a takeoff, landing or waypoint at `point`, made on the first visit.
void fly_to_item(Follower& follower, Cursor& cursor, GeodeticPoint point) {
  const MissionItem& item = follower.mission.items[cursor.item];
  const CommandInfo info = command_info(item.command);
  int& known = follower.vertex_of_item[cursor.item];
  if (known >= 0) {
    const RouteVertex again = follower.route.vertices[static_cast<std::size_t>(known)];
    fly_item_to(follower, cursor, again, known);
    cursor.keep_height_of(again);
    return;
  }
  RouteVertex vertex;
  vertex.point = point;
  vertex.speed_mps = cursor.speed_mps;
  vertex.source_item = item.index;
  vertex.kind = item.kind.empty() ? std::string(info.name) : item.kind;
  vertex.on_ground = info.role == CommandRole::kLand;
  if (!keeps_height_before(follower, cursor, item)) {
    set_height(follower, item, vertex);
  } else {
    altitude_frame(follower, item);
    vertex.amsl_m = cursor.kept_amsl_m;
    vertex.agl_m = cursor.kept_agl_m;
    follower.kept_height.push_back(cursor.item);
  }
  if (!vertex.on_ground) cursor.keep_height_of(vertex);
  const auto& home = follower.mission.home;
  if (info.role == CommandRole::kTakeoff && cursor.vertex < 0 && home &&
      geodesic_between(home->point, point).length_m > kAtHome_m) {
    RouteVertex start = vertex;
    start.point = home->point;
    start.source_item = -1;
    start.kind = "home";
    fly_to(follower, cursor, append_vertex(follower.route, start));
    add_note(follower.route,
             "The aircraft is assumed to climb over home and to fly from there to the takeoff position.");
  }
  const auto count = follower.route.vertices.size();
  if (const auto radius_m = circle_radius_m(follower, item)) {
    known = fly_circle(follower, cursor, vertex, *radius_m);
    follower.became[cursor.item] = "circle of radius " + format_number(std::abs(*radius_m)) + " m, " +
                                   std::to_string(follower.route.vertices.size() - count) + " vertices";
    return;
  }
  fly_item_to(follower, cursor, vertex, known);
  const auto added = follower.route.vertices.size() - count;
  follower.became[cursor.item] = added == 1   ? "vertex"
                                 : added == 0 ? kSamePlaceText
                                              : "spline, " + std::to_string(added) + " vertices";
}

void visit_path_item(Follower& follower, Cursor& cursor) {
  const MissionItem& item = follower.mission.items[cursor.item];
  std::string& became = follower.became[cursor.item];
  if (has_position(follower, item)) {
    fly_to_item(follower, cursor, checked_point(item.params[4], item.params[5], where(follower, item)));
    return;
  }
  altitude_frame(follower, item);
  const bool is_takeoff = command_info(item.command).role == CommandRole::kTakeoff;
  if (is_takeoff && cursor.vertex >= 0) {
    fly_to_item(follower, cursor, follower.route.vertices[static_cast<std::size_t>(cursor.vertex)].point);
  } else if (is_takeoff && follower.mission.home) {
    fly_to_item(follower, cursor, follower.mission.home->point);
  } else if (is_takeoff) {
    became = "left out: it has no position, and the file has no home";
    add_note(follower.route,
             "The takeoff has no position and the file no home: the route starts at the next position.");
  } else {
    became = "no vertex: it has no position (lat = lon = 0) and happens where the aircraft is";
  }
}

void visit_return(Follower& follower, Cursor& cursor) {
  std::string& became = follower.became[cursor.item];
  if (!follower.mission.home) {
    became = "left out: the file has no home to return to";
    add_note(follower.route, "The return to launch is left out, because the file has no home position.");
    return;
  }
  if (cursor.vertex < 0) {
    became = "left out: the aircraft has not been anywhere";
    return;
  }
  int& known = follower.vertex_of_item[cursor.item];
  if (known < 0) {
    RouteVertex vertex = follower.route.vertices[static_cast<std::size_t>(cursor.vertex)];
    vertex.point = follower.mission.home->point;
    vertex.speed_mps = cursor.speed_mps;
    vertex.source_item = follower.mission.items[cursor.item].index;
    vertex.kind = "return";
    vertex.on_ground = false;
    known = append_vertex(follower.route, vertex);
    became = "leg to home";
    add_note(follower.route,
             "The return to launch is assumed to be flown straight to home at the height of the position before; the "
             "autopilot's own return height is not in the file.");
  }
  fly_to(follower, cursor, known);
}

void visit_speed(Follower& follower, Cursor& cursor) {
  const MissionItem& item = follower.mission.items[cursor.item];
  const double type = item.params[0];
  const double speed_mps = item.params[1];
  std::string& became = follower.became[cursor.item];
  const bool horizontal = std::isnan(type) || type == 0 || type == 1;
  if (!horizontal || !(speed_mps > 0) || speed_mps > 1000) {
    became = "no change of speed over ground";
    return;
  }
  cursor.speed_mps = speed_mps;
  became = "speed " + format_number(speed_mps) + " m/s from here on";
  if (type != 1) {
    add_note(follower.route,
             "Airspeed is taken as the planned speed: what wind makes of it is in the P of the route, not in times.");
  }
}

/// On the way to the next position, which has the height if it names none of its own.
void visit_climb(Follower& follower, Cursor& cursor) {
  const MissionItem& item = follower.mission.items[cursor.item];
  std::string& became = follower.became[cursor.item];
  if (follower.options.agl_m) {
    became = "no change of height: the route is flown at a constant height above ground";
    return;
  }
  RouteVertex height;
  set_height(follower, item, height);
  cursor.keep_height_of(height);
  const std::string text = height_text(height.amsl_m, height.agl_m);
  became = "height " + text + " from here on, where an item has none of its own";
  add_note(follower.route, "Item " + std::to_string(item.index) + " (" + mission_command_name(item.command) + ", to " +
                               text +
                               ") is taken to be flown on the way to the next position, at whose height it ends.");
}

/// Where a jump leads, and what is left of the way that does not jump.
void visit_jump(Follower& follower, Cursor& cursor, bool by_tag) {
  const MissionItem& item = follower.mission.items[cursor.item];
  const auto& targets = by_tag ? follower.item_of_tag : follower.item_of_sequence;
  const double number = item.params[0];
  const double times = std::isnan(item.params[1]) ? 0 : item.params[1];
  const bool in_range = std::isfinite(number) && std::abs(number) < 1e9;
  const auto target = in_range ? targets.find(static_cast<int>(number)) : targets.end();
  if (target == targets.end()) {
    throw DataError(where(follower, item) + ": jumps to " + (by_tag ? "tag " : "item ") + format_number(number) +
                    ", which does not exist");
  }
  std::string& became = follower.became[cursor.item];
  const std::size_t next = cursor.item + 1;
  if (times == 0) {
    became = "no leg: it jumps 0 times";
    cursor.item = next;
    return;
  }
  became = "jump, each leg of the loop stands once";
  if (times > 0) {
    Cursor rest = cursor;
    rest.item = next;
    follower.open.push_back(rest);
  } else {
    add_note(follower.route, "Item " + std::to_string(item.index) + " jumps without end; the loop is flown once.");
  }
  add_note(follower.route,
           "The mission loops: each distinct leg stands once, so distances along the route, the time of flight and the "
           "probabilities count it once. A flight that repeats a loop drifts and takes fixes there again.");
  cursor.item = target->second;
}

/// One item; moves the cursor on.
void visit(Follower& follower, Cursor& cursor) {
  const MissionItem& item = follower.mission.items[cursor.item];
  const CommandInfo info = command_info(item.command);
  std::string& became = follower.became[cursor.item];
  switch (info.role) {
    case CommandRole::kPath:
    case CommandRole::kTakeoff:
    case CommandRole::kLand:
      visit_path_item(follower, cursor);
      break;
    case CommandRole::kReturn:
      visit_return(follower, cursor);
      break;
    case CommandRole::kSpeed:
      visit_speed(follower, cursor);
      break;
    case CommandRole::kClimb:
      visit_climb(follower, cursor);
      break;
    case CommandRole::kJump:
      visit_jump(follower, cursor, false);
      return;
    case CommandRole::kJumpToTag:
      visit_jump(follower, cursor, true);
      return;
    case CommandRole::kTag:
      became = "target of jumps";
      break;
    case CommandRole::kLocal:
      throw DataError(where(follower, item) + ": paths in local coordinates are not supported");
    case CommandRole::kPlaceNotFlownTo:
      became = "left out: its position is not flown to";
      if (item.command == 179) {
        add_note(follower.route,
                 "\"Set home\" is not followed: return and relative heights stay with the planned home.");
      }
      break;
    case CommandRole::kNoPlace:
      became = "left out: it has no position";
      break;
    case CommandRole::kUnknown:
      became = "left out: an unknown command";
      add_note(follower.route, "Item " + std::to_string(item.index) + " is left out: command " +
                                   std::to_string(item.command) + " is not known.");
      break;
  }
  ++cursor.item;
}

void follow(Follower& follower) {
  Cursor begin;
  begin.speed_mps = follower.mission.speed_mps;
  follower.open.push_back(begin);
  while (!follower.open.empty()) {
    Cursor cursor = follower.open.back();
    follower.open.pop_back();
    while (cursor.item < follower.mission.items.size() && follower.visited.emplace(cursor.item, cursor.vertex).second) {
      if (follower.visited.size() > kMaxSteps) throw DataError(follower.route.name + ": has too many jumps to follow");
      visit(follower, cursor);
    }
  }
}

/// What the mission items of each file item became, in one sentence each.
void append_items(Follower& follower) {
  const auto& items = follower.mission.items;
  for (std::size_t first = 0; first < items.size();) {
    std::size_t end = first + 1;
    while (end < items.size() && items[end].index == items[first].index) ++end;
    RouteItem summary{items[first].index, items[first].command, mission_command_name(items[first].command), ""};
    if (end - first == 1 && items[first].kind.empty()) {
      summary.became = follower.became[first].empty() ? "not reached: a jump leads past it" : follower.became[first];
    } else {
      std::size_t vertices = 0;
      for (std::size_t i = first; i < end; ++i) vertices += follower.became[i] == "vertex" ? 1 : 0;
      summary.command = -1;
      summary.what = items[first].kind;
      summary.became =
          std::to_string(vertices) + " vertices from its " + std::to_string(end - first) + " mission items";
    }
    follower.route.items.push_back(std::move(summary));
    first = end;
  }
}

}  // namespace

std::string mission_command_name(int command) {
  const CommandInfo info = command_info(command);
  return info.role == CommandRole::kUnknown ? "command " + std::to_string(command) : std::string(info.name);
}

void append_mission(Route& route, const MavlinkMission& mission, const RouteOptions& options) {
  Follower follower{route, mission, options};
  follower.vertex_of_item.assign(mission.items.size(), -1);
  follower.became.resize(mission.items.size());
  for (std::size_t i = 0; i < mission.items.size(); ++i) {
    const MissionItem& item = mission.items[i];
    follower.item_of_sequence.emplace(item.sequence, i);
    if (item.command == 600 && std::abs(item.params[0]) < 1e9) {
      follower.item_of_tag.emplace(static_cast<int>(item.params[0]), i);
    }
  }
  route.home = mission.home;
  if (route.home && options.home_amsl_m) route.home->amsl_m = *options.home_amsl_m;
  follow(follower);
  if (!follower.kept_height.empty()) {
    const MissionItem& first = mission.items[follower.kept_height.front()];
    const std::size_t count = follower.kept_height.size();
    add_note(route, (count == 1 ? "Item " : std::to_string(count) + " items (the first: item ") +
                        std::to_string(first.index) + (count == 1 ? " has" : ") have") +
                        " a height of 0: the height before is kept, as ArduPilot flies. PX4 would fly at 0 m.");
  }
  const auto is_spline = [](const MissionItem& item) { return item.command == kSplineWaypoint; };
  if (std::any_of(mission.items.begin(), mission.items.end(), is_spline)) {
    add_note(route, "Spline waypoints are flown as ArduCopter does, as chords that leave its curve by " +
                        format_number(kChordError_m) + " m at most; the curves leave the straight legs by " +
                        format_fixed(follower.widest_spline_m, follower.widest_spline_m < 10 ? 1 : 0) +
                        " m at most. PX4 and ArduPlane do not fly spline waypoints.");
  }
  append_items(follower);
}

}  // namespace pilotage
