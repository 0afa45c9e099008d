#include "pilotage/tile/denied_stretches.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string_view>
#include <system_error>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/base/utf8.h"

namespace pilotage {
namespace {

constexpr double kRounded_m = 50;  // what a distance in kilometres with one decimal may be too long
constexpr const char* kAllowed =
    "; allowed are stretches in km along the route as 3.2-7.5, files of polygons, anywhere, and all";

std::string km_text(double distance_m) {
  return format_number(std::round(distance_m) / 1000) + " km";
}

[[noreturn]] void refuse(const std::string& text, const std::string& why) {
  throw UsageError("denied = \"" + name_as_utf8(text) + "\" " + why);
}

std::vector<std::string_view> split_at_commas(std::string_view text) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

// "3.2-7.5" as two numbers; nothing when it is none. Ranges are also written with an en dash.
std::optional<std::pair<double, double>> two_numbers(std::string_view part) {
  while (part.starts_with(' ')) part.remove_prefix(1);
  while (part.ends_with(' ')) part.remove_suffix(1);
  for (const std::string_view dash : {std::string_view("–"), std::string_view("-")}) {
    const std::size_t at = part.find(dash, 1);
    if (at == std::string_view::npos) continue;
    const auto from = parse_number(part.substr(0, at));
    const auto to = parse_number(part.substr(at + dash.size()));
    if (from && to) return std::pair(*from, *to);
  }
  return std::nullopt;
}

std::vector<DeniedStretch> stretches_of_text(const std::string& text, double length_m) {
  std::vector<DeniedStretch> stretches;
  for (const std::string_view part : split_at_commas(text)) {
    const auto numbers = two_numbers(part);
    if (!numbers) refuse(text, std::string("is neither a stretch nor a file that is there") + kAllowed);
    const auto [from_km, to_km] = *numbers;
    if (!std::isfinite(from_km) || !std::isfinite(to_km)) refuse(text, "has an end that is no finite number");
    if (!(from_km >= 0 && from_km * 1000 < length_m && to_km * 1000 <= length_m + kRounded_m)) {
      refuse(text, "lies outside the route, which has 0 to " + km_text(length_m));
    }
    if (!(from_km < to_km)) refuse(text, "has no length: its first end must come before its second");
    stretches.push_back({from_km * 1000, std::min(to_km * 1000, length_m)});
  }
  return stretches;
}

// Joins what overlaps or touches.
std::vector<DeniedStretch> merged(std::vector<DeniedStretch> stretches) {
  std::sort(stretches.begin(), stretches.end(), [](const DeniedStretch& a, const DeniedStretch& b) {
    return std::pair(a.from_distance_m, a.to_distance_m) < std::pair(b.from_distance_m, b.to_distance_m);
  });
  std::vector<DeniedStretch> apart;
  for (const DeniedStretch& stretch : stretches) {
    if (!apart.empty() && stretch.from_distance_m <= apart.back().to_distance_m) {
      apart.back().to_distance_m = std::max(apart.back().to_distance_m, stretch.to_distance_m);
    } else {
      apart.push_back(stretch);
    }
  }
  return apart;
}

// Longitude and latitude as a plane.
struct PlanePoint {
  double x = 0;
  double y = 0;
};

PlanePoint between(PlanePoint a, PlanePoint b, double share) {
  return {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)};
}

// Calls visit(c, d) for each edge of the area.
template <class Visit>
void for_each_edge(const GeodeticArea& area, Visit visit) {
  for (const auto& ring : area.rings) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const GeodeticPoint c = ring[i];
      const GeodeticPoint d = ring[(i + 1) % ring.size()];
      visit(PlanePoint{c.lon_deg, c.lat_deg}, PlanePoint{d.lon_deg, d.lat_deg});
    }
  }
}

// By the number of edges to the east of it: odd is inside, whatever ring they are of.
bool lies_inside(PlanePoint point, const GeodeticArea& area) {
  bool inside = false;
  for_each_edge(area, [&](PlanePoint c, PlanePoint d) {
    if ((c.y > point.y) == (d.y > point.y)) return;
    const double x = c.x + (point.y - c.y) / (d.y - c.y) * (d.x - c.x);
    if (x > point.x) inside = !inside;
  });
  return inside;
}

// Where the way from a to b crosses edges, as shares of it, with 0 and 1, ascending.
std::vector<double> crossings(PlanePoint a, PlanePoint b, const GeodeticArea& area) {
  std::vector<double> shares = {0, 1};
  for_each_edge(area, [&](PlanePoint c, PlanePoint d) {
    const double turn = (b.x - a.x) * (d.y - c.y) - (b.y - a.y) * (d.x - c.x);
    if (turn == 0) return;  // along the edge: its neighbours' crossings tell
    const double share = ((c.x - a.x) * (d.y - c.y) - (c.y - a.y) * (d.x - c.x)) / turn;
    const double along_edge = ((c.x - a.x) * (b.y - a.y) - (c.y - a.y) * (b.x - a.x)) / turn;
    if (share > 0 && share < 1 && along_edge >= 0 && along_edge <= 1) shares.push_back(share);
  });
  std::sort(shares.begin(), shares.end());
  return shares;
}

struct PlaneBox {
  PlanePoint low{INFINITY, INFINITY};
  PlanePoint high{-INFINITY, -INFINITY};
};

PlaneBox box_of(const GeodeticArea& area) {
  PlaneBox box;
  for_each_edge(area, [&](PlanePoint c, PlanePoint) {
    box.low = {std::min(box.low.x, c.x), std::min(box.low.y, c.y)};
    box.high = {std::max(box.high.x, c.x), std::max(box.high.y, c.y)};
  });
  return box;
}

}  // namespace

std::vector<DeniedStretch> stretches_inside(const GeodeticArea& area, const std::vector<FlightSample>& samples) {
  const PlaneBox box = box_of(area);
  std::vector<DeniedStretch> stretches;
  const auto add_step = [&](std::size_t i, double shift_deg) {
    const double from_m = samples[i].distance_m;
    const double length_m = samples[i + 1].distance_m - from_m;
    const GeodeticPoint from = samples[i].point;
    const GeodeticPoint to = samples[i + 1].point;
    const PlanePoint a{from.lon_deg + shift_deg, from.lat_deg};
    const PlanePoint b{unwrap_lon_deg(to.lon_deg, from.lon_deg) + shift_deg, to.lat_deg};
    const bool apart = std::max(a.x, b.x) < box.low.x || std::min(a.x, b.x) > box.high.x ||
                       std::max(a.y, b.y) < box.low.y || std::min(a.y, b.y) > box.high.y;
    if (apart || !(length_m > 0)) return;
    const std::vector<double> shares = crossings(a, b, area);
    const auto rounded_m = [&](double share) {
      return std::min(std::round((from_m + share * length_m) * 100) / 100, samples.back().distance_m);
    };
    for (std::size_t k = 0; k + 1 < shares.size(); ++k) {
      if (!lies_inside(between(a, b, (shares[k] + shares[k + 1]) / 2), area)) continue;
      const DeniedStretch stretch{rounded_m(shares[k]), rounded_m(shares[k + 1])};
      if (stretch.from_distance_m < stretch.to_distance_m) stretches.push_back(stretch);
    }
  };
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
    for (const double shift_deg : {-360.0, 0.0, 360.0}) add_step(i, shift_deg);  // corners beyond 180
  }
  return merged(std::move(stretches));
}

GnssDenial read_denial(const std::vector<std::string>& given, const std::vector<FlightSample>& samples,
                       std::vector<std::string>& warnings) {
  GnssDenial denied;
  for (const std::string& text : given) {
    if (text != "all" && text != "anywhere") continue;
    if (given.size() > 1) refuse(text, "says where on all of the route; it stands alone");
    denied.anywhere = text == "anywhere";
    return denied;
  }
  const double length_m = samples.back().distance_m;
  for (const std::string& text : given) {
    std::error_code ignored;
    std::vector<DeniedStretch> stretches;
    if (std::filesystem::exists(text, ignored)) {
      denied.files.push_back(text);
      const std::vector<GeodeticArea> areas = read_areas(text);
      for (const GeodeticArea& area : areas) {
        for (const DeniedStretch& stretch : stretches_inside(area, samples)) stretches.push_back(stretch);
      }
      if (stretches.empty()) {
        warnings.push_back("the route enters none of the " + std::to_string(areas.size()) + " polygons of " +
                           name_as_utf8(text) + ", in which GNSS is denied");
      }
    } else {
      stretches = stretches_of_text(text, length_m);
    }
    denied.stretches.insert(denied.stretches.end(), stretches.begin(), stretches.end());
  }
  denied.stretches = merged(std::move(denied.stretches));
  if (denied.stretches.empty() && !given.empty()) {
    throw DataError(warnings.back() + ": GNSS would never be lost, and there is nothing to plan for");
  }
  return denied;
}

}  // namespace pilotage
