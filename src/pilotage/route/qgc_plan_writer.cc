#include "pilotage/route/qgc_plan_writer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/text.h"
#include "pilotage/geo/geodesic.h"
#include "pilotage/route/mission_command.h"
#include "pilotage/route/mission_items.h"
#include "pilotage/route/qgc_plan.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kWaypoint = 16;
constexpr int kChangeSpeed = 178;
constexpr int kAboveSea = 0;
constexpr int kAboveTerrain = 10;

double rounded(double value, double steps) {
  return std::round(value * steps) / steps;
}

// QGroundControl's own way to show the altitude, which goes with the frame.
int altitude_mode(int frame) {
  if (frame == kAboveSea) return 2;
  return frame == kAboveTerrain ? 4 : 1;
}

Json waypoint_item(int number, int frame, GeodeticPoint point, double altitude_m) {
  const double lat_deg = rounded(point.lat_deg, 1e7);
  const double lon_deg = rounded(point.lon_deg, 1e7);
  return {{"AMSLAltAboveTerrain", nullptr},
          {"Altitude", altitude_m},
          {"AltitudeMode", altitude_mode(frame)},
          {"autoContinue", true},
          {"command", kWaypoint},
          {"doJumpId", number},
          {"frame", frame},
          {"params", Json::array({0, 0, 0, nullptr, lat_deg, lon_deg, altitude_m})},
          {"type", "SimpleItem"}};
}

Json speed_item(int number, double speed_mps) {
  return {{"autoContinue", true},
          {"command", kChangeSpeed},
          {"doJumpId", number},
          {"frame", 2},
          {"params", Json::array({1, speed_mps, -1, 0, 0, 0, 0})},
          {"type", "SimpleItem"}};
}

bool is_simple(const Json& item) {
  return item.at("type") == "SimpleItem";
}

CommandRole role_of(const Json& item) {
  return is_simple(item) ? command_info(item.at("command").get<int>()).role : CommandRole::kPath;
}

// Is the aircraft led somewhere by it? An item of a path command without a position happens where the aircraft is.
bool leads_the_way(const Json& item) {
  if (!is_simple(item)) return true;
  const CommandRole role = role_of(item);
  if (role != CommandRole::kPath && role != CommandRole::kLand && role != CommandRole::kTakeoff) return false;
  const Json& params = item.at("params");
  const auto is_zero = [](const Json& value) { return value.is_null() || value.get<double>() == 0; };
  return !(is_zero(params[4]) && is_zero(params[5]));
}

std::string item_text(const Json& item, int number) {
  const std::string what = is_simple(item) ? mission_command_name(item.at("command").get<int>())
                                           : item.at("complexItemType").get<std::string>();
  return "item " + std::to_string(number) + " (" + what + ")";
}

// What an item that leads the way does besides; "" for a plain waypoint.
std::string besides(const Json& item) {
  if (!is_simple(item)) return "its pattern is not flown";
  const int command = item.at("command").get<int>();
  if (command == 82) return "its spline is not flown";
  if (command != kWaypoint) return "it is not done";
  const Json& hold = item.at("params")[0];
  if (hold.is_number() && hold.get<double>() > 0) {
    return "its hold of " + format_number(hold.get<double>()) + " s is not done";
  }
  return "";
}

// How many numbers of the mission an element takes.
int number_count(const Json& item) {
  if (is_simple(item)) return 1;
  const auto transects = item.find("TransectStyleComplexItem");
  if (transects == item.end() || !transects->contains("Items")) return 1;
  return std::max(1, static_cast<int>(transects->at("Items").size()));
}

void shift_numbers(Json& item, int by) {
  if (by == 0) return;
  const auto shift = [by](Json& one) {
    if (one.contains("doJumpId") && one["doJumpId"].is_number_integer()) {
      one["doJumpId"] = one["doJumpId"].get<int>() + by;
    }
  };
  shift(item);
  const auto transects = item.find("TransectStyleComplexItem");
  if (transects == item.end() || !transects->contains("Items")) return;
  for (Json& one : (*transects)["Items"]) shift(one);
}

// A moved stretch in terms of the list of items: those strictly between `from` and `to` lie on it.
struct ItemStretch {
  std::ptrdiff_t from = -1;  ///< -1: home.
  std::ptrdiff_t to = 0;
  const MovedStretch* moved = nullptr;
};

std::ptrdiff_t position_of(const std::vector<int>& numbers, int number, const std::string& name) {
  if (number < 0) return -1;
  // The number of a survey's first command, or one inside it: the last element that does not begin behind it.
  const auto behind = std::upper_bound(numbers.begin(), numbers.end(), number);
  if (behind == numbers.begin()) throw DataError(name + ": has no item " + std::to_string(number));
  return behind - numbers.begin() - 1;
}

std::optional<int> frame_of(const Json& items, std::ptrdiff_t at) {
  if (at < 0) return std::nullopt;
  const Json& item = items[static_cast<std::size_t>(at)];
  if (!is_simple(item) || role_of(item) == CommandRole::kReturn) return std::nullopt;
  const int frame = item.at("frame").get<int>();
  const bool has_place = frame == 0 || frame == 3 || frame == 5 || frame == 6 || frame == 10 || frame == 11;
  return has_place ? std::optional(frame) : std::nullopt;
}

double altitude_in_file_m(const Json& items, std::ptrdiff_t at) {
  if (at < 0) return kNaN;
  const Json& item = items[static_cast<std::size_t>(at)];
  if (!frame_of(items, at)) return kNaN;
  const Json& altitude = item.at("params")[6];
  return altitude.is_number() ? altitude.get<double>() : kNaN;
}

// The altitude of a new waypoint in a frame; what the file's own ends say where the route's heights are not the file's.
double altitude_m(const PlanWaypoint& waypoint, int frame, const Route& route, double from_m, double to_m) {
  const bool above_home = frame == 3 || frame == 6;
  const bool above_terrain = frame == 10 || frame == 11;
  double altitude_m = kNaN;
  if (above_terrain) {
    altitude_m = waypoint.agl_m;
  } else if (above_home) {
    altitude_m = waypoint.amsl_m - (route.home ? route.home->amsl_m : kNaN);
  } else {
    altitude_m = waypoint.amsl_m;
  }
  if (std::isfinite(altitude_m)) return rounded(altitude_m, 100);
  if (!std::isfinite(from_m)) from_m = to_m;
  if (!std::isfinite(to_m)) to_m = from_m;
  return rounded(from_m + waypoint.share * (to_m - from_m), 100);
}

// Of the points of a stretch (its first vertex, then the new waypoints) the nearest to `place`, from `first` on.
std::size_t nearest_stop(const std::vector<GeodeticPoint>& stops, GeodeticPoint place, std::size_t first) {
  std::size_t best = first;
  double best_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = first; i < stops.size(); ++i) {
    const double distance_m = geodesic_between(stops[i], place).length_m;
    if (distance_m < best_m) {
      best = i;
      best_m = distance_m;
    }
  }
  return best;
}

// Replaces what lies on one stretch; the list of items grows in `out`.
class StretchMover {
 public:
  StretchMover(const Json& items, const std::vector<int>& numbers, const Route& route, MovedPlan& result)
      : items_(items), numbers_(numbers), route_(route), result_(result) {}

  void copy(std::ptrdiff_t at) {
    Json item = items_[static_cast<std::size_t>(at)];
    shift_numbers(item, shift_);
    out_.push_back(std::move(item));
  }

  void replace(const ItemStretch& stretch) {
    const MovedStretch& moved = *stretch.moved;
    std::vector<GeodeticPoint> stops = {route_.vertices[static_cast<std::size_t>(moved.from_vertex)].point};
    for (const PlanWaypoint& waypoint : moved.waypoints) stops.push_back(waypoint.point);
    // Items without a place, by the stop they now follow.
    std::vector<std::vector<std::ptrdiff_t>> staying(stops.size());
    std::size_t stop = 0;
    GeodeticPoint place = stops.front();
    bool passed_one = false;
    for (std::ptrdiff_t at = stretch.from + 1; at < stretch.to; ++at) {
      const Json& item = items_[static_cast<std::size_t>(at)];
      const int number = numbers_[static_cast<std::size_t>(at)];
      if (leads_the_way(item)) {
        result_.removed.push_back(item_text(item, number));
        const std::string lost = besides(item);
        if (!lost.empty()) result_.lost.push_back(item_text(item, number) + " had to go: " + lost);
        for (const RouteVertex& vertex : route_.vertices) {
          if (vertex.source_item >= number && vertex.source_item < number + number_count(item)) place = vertex.point;
        }
        passed_one = true;
        continue;
      }
      if (passed_one) {
        stop = nearest_stop(stops, place, stop);
        result_.shifted.push_back(
            item_text(item, number) + " now happens " +
            (stop == 0 ? "where its stretch begins" : "at waypoint " + std::to_string(stop) + " of its stretch") +
            ", " + format_fixed(geodesic_between(stops[stop], place).length_m, 0) + " m from where it was planned");
      }
      staying[stop].push_back(at);
    }
    int next = stretch.from < 0 ? 1
                                : numbers_[static_cast<std::size_t>(stretch.from)] + shift_ +
                                      number_count(items_[static_cast<std::size_t>(stretch.from)]);
    const int frame = frame_of(items_, stretch.from).value_or(frame_of(items_, stretch.to).value_or(kAboveSea));
    const double from_m = altitude_in_file_m(items_, stretch.from);
    const double to_m = altitude_in_file_m(items_, stretch.to);
    const auto put = [&](Json item) {
      item["doJumpId"] = next++;
      out_.push_back(std::move(item));
    };
    for (std::size_t i = 0; i < stops.size(); ++i) {
      if (i > 0) {
        const PlanWaypoint& waypoint = moved.waypoints[i - 1];
        put(waypoint_item(0, frame, waypoint.point, altitude_m(waypoint, frame, route_, from_m, to_m)));
      }
      for (const std::ptrdiff_t at : staying[i]) put(items_[static_cast<std::size_t>(at)]);
    }
    if (stretch.to < std::ssize(numbers_)) shift_ = next - numbers_[static_cast<std::size_t>(stretch.to)];
  }

  Json take() { return std::move(out_); }

 private:
  const Json& items_;
  const std::vector<int>& numbers_;
  const Route& route_;
  MovedPlan& result_;
  Json out_ = Json::array();
  int shift_ = 0;  ///< Of the numbers of the items to come.
};

}  // namespace

void require_one_line(const Route& route) {
  for (std::size_t i = 1; i < route.legs.size(); ++i) {
    if (route.legs[i].from == route.legs[i - 1].to) continue;
    // A vertical climb is two vertices at one place without a leg between them.
    const GeodeticPoint a = route.vertices[static_cast<std::size_t>(route.legs[i - 1].to)].point;
    const GeodeticPoint b = route.vertices[static_cast<std::size_t>(route.legs[i].from)].point;
    if (geodesic_between(a, b).length_m < 0.01) continue;
    throw DataError(route.name + ": leg " + std::to_string(i + 1) + " does not begin where leg " + std::to_string(i) +
                    " ends, as in a mission with jumps; its line cannot be moved");
  }
}

MovedPlan move_stretches(const std::string& name, const Json& json, const Route& route,
                         const std::vector<MovedStretch>& stretches) {
  const std::vector<int> numbers = qgc_item_numbers(name, json);
  const Json& items = json.at("mission").at("items");
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const CommandRole role = role_of(items[i]);
    if (role == CommandRole::kJump || role == CommandRole::kJumpToTag) {
      throw DataError(name + ": " + item_text(items[i], numbers[i]) +
                      " jumps to another item; the line of a mission with jumps cannot be moved");
    }
  }
  MovedPlan result;
  result.json = json;
  std::vector<ItemStretch> moved;
  for (const MovedStretch& stretch : stretches) {
    const auto item_of = [&](int vertex) {
      return position_of(numbers, route.vertices[static_cast<std::size_t>(vertex)].source_item, name);
    };
    moved.push_back({item_of(stretch.from_vertex), item_of(stretch.to_vertex), &stretch});
  }
  std::sort(moved.begin(), moved.end(), [](const ItemStretch& a, const ItemStretch& b) { return a.from < b.from; });
  StretchMover mover(items, numbers, route, result);
  std::ptrdiff_t at = 0;
  for (const ItemStretch& stretch : moved) {
    if (stretch.to <= stretch.from) throw DataError(name + ": a stretch that is to be moved has no items of its own");
    for (; at <= stretch.from; ++at) mover.copy(at);
    mover.replace(stretch);
    at = stretch.to;
  }
  for (; at < std::ssize(numbers); ++at) mover.copy(at);
  result.json["mission"]["items"] = mover.take();
  return result;
}

Json plan_of_route(const Route& route) {
  require_one_line(route);
  Json items = Json::array();
  double speed_mps = kNaN;
  double first_speed_mps = kNaN;
  const auto add = [&](int index) {
    const RouteVertex& vertex = route.vertices[static_cast<std::size_t>(index)];
    const int frame = std::isfinite(vertex.agl_m) ? kAboveTerrain : kAboveSea;
    items.push_back(waypoint_item(static_cast<int>(items.size()) + 1, frame, vertex.point,
                                  frame == kAboveTerrain ? vertex.agl_m : vertex.amsl_m));
    items.back()["params"][4] = vertex.point.lat_deg;  // as it is, so that the same line comes back
    items.back()["params"][5] = vertex.point.lon_deg;
  };
  for (std::size_t i = 0; i < route.legs.size(); ++i) {
    const RouteLeg& leg = route.legs[i];
    const bool climbs = i > 0 && leg.from != route.legs[i - 1].to;
    if (i == 0 || climbs) add(leg.from);
    const double leg_speed_mps = route.vertices[static_cast<std::size_t>(leg.to)].speed_mps;
    if (std::isfinite(leg_speed_mps) && !(leg_speed_mps == speed_mps)) {
      if (std::isfinite(speed_mps)) items.push_back(speed_item(static_cast<int>(items.size()) + 1, leg_speed_mps));
      if (std::isnan(first_speed_mps)) first_speed_mps = leg_speed_mps;
      speed_mps = leg_speed_mps;
    }
    add(leg.to);
  }
  const GeodeticPoint home =
      route.home ? route.home->point : route.vertices[static_cast<std::size_t>(route.legs.front().from)].point;
  const double home_amsl_m = route.home ? route.home->amsl_m : kNaN;
  Json mission = {{"cruiseSpeed", std::isfinite(first_speed_mps) ? Json(first_speed_mps) : Json(15)},
                  {"firmwareType", 0},
                  {"globalPlanAltitudeMode", 0},
                  {"hoverSpeed", 5},
                  {"items", std::move(items)},
                  {"plannedHomePosition", Json::array({home.lat_deg, home.lon_deg, json_number(home_amsl_m)})},
                  {"vehicleType", 1},
                  {"version", 2}};
  if (std::isnan(first_speed_mps)) mission["cruiseSpeed"] = nullptr;
  return {{"fileType", "Plan"},
          {"geoFence", {{"circles", Json::array()}, {"polygons", Json::array()}, {"version", 2}}},
          {"groundStation", "QGroundControl"},
          {"mission", std::move(mission)},
          {"rallyPoints", {{"points", Json::array()}, {"version", 2}}},
          {"version", 1}};
}

}  // namespace pilotage
