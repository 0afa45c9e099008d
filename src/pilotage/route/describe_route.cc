#include "pilotage/route/describe_route.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "pilotage/base/text.h"

namespace pilotage {
namespace {

std::string pad_left(const std::string& text, std::size_t width) {
  return text.size() < width ? std::string(width - text.size(), ' ') + text : text;
}

std::string number_or_dash(double value, int decimals) {
  return std::isnan(value) ? "-" : format_fixed(value, decimals);
}

/// "12 … 340 m", "120 m", or nothing when no vertex has one.
std::string range_text(const Route& route, double RouteVertex::*member, int decimals, const std::string& unit) {
  double least = INFINITY;
  double most = -INFINITY;
  for (const RouteVertex& vertex : route.vertices) {
    if (std::isnan(vertex.*member)) continue;
    least = std::min(least, vertex.*member);
    most = std::max(most, vertex.*member);
  }
  if (least > most) return "";
  if (least == most) return format_fixed(least, decimals) + " " + unit;
  return format_fixed(least, decimals) + " to " + format_fixed(most, decimals) + " " + unit;
}

/// Rows 0 … count − 1, the middle left out when there are more than `max_rows`.
void append_rows(std::string& text, std::size_t count, std::size_t max_rows,
                 const std::function<std::string(std::size_t)>& row) {
  const std::size_t shown_first = count <= max_rows ? count : (max_rows + 1) / 2;
  const std::size_t shown_last = count <= max_rows ? 0 : max_rows / 2;
  for (std::size_t i = 0; i < shown_first; ++i) text += row(i) + "\n";
  if (shown_first + shown_last < count) {
    text += "  … " + std::to_string(count - shown_first - shown_last) + " more …\n";
  }
  for (std::size_t i = count - shown_last; i < count; ++i) text += row(i) + "\n";
}

double duration_s(const Route& route) {
  double duration = 0;
  for (const RouteLeg& leg : route.legs)
    duration += leg.length_m / route.vertices[static_cast<std::size_t>(leg.to)].speed_mps;
  return duration;  // NaN when a speed is not known
}

std::string summary(const Route& route) {
  std::string text = route.name + ": " + route.format + "\n";
  text += "  length " + format_fixed(route_length_m(route) / 1000, 3) + " km, " +
          std::to_string(route.vertices.size()) + " vertices, " + std::to_string(route.legs.size()) + " legs\n";
  const double seconds = duration_s(route);
  if (std::isfinite(seconds)) text += "  duration " + format_fixed(seconds, 0) + " s\n";
  const std::string amsl = range_text(route, &RouteVertex::amsl_m, 1, "m above sea level");
  const std::string agl = range_text(route, &RouteVertex::agl_m, 1, "m above ground");
  text += "  height " +
          (amsl.empty() && agl.empty() ? "not known" : amsl + (amsl.empty() || agl.empty() ? "" : ", ") + agl) + "\n";
  const std::string speed = range_text(route, &RouteVertex::speed_mps, 1, "m/s");
  text += "  speed " + (speed.empty() ? "not known" : speed) + "\n";
  if (route.home) {
    text += "  home lat " + format_fixed(route.home->point.lat_deg, 7) + ", lon " +
            format_fixed(route.home->point.lon_deg, 7) + ", " +
            (std::isnan(route.home->amsl_m) ? std::string("height not known")
                                            : format_fixed(route.home->amsl_m, 1) + " m above sea level") +
            "\n";
  }
  if (route.camera) {
    const RouteCamera& camera = *route.camera;
    text += "  camera \"" + camera.name + "\", sensor " + format_number(camera.sensor_width_mm) + " x " +
            format_number(camera.sensor_height_mm) + " mm, focal length " + format_number(camera.focal_length_mm) +
            " mm, " + std::to_string(camera.image_width_px) + " x " + std::to_string(camera.image_height_px) + " px\n";
  }
  return text;
}

}  // namespace

std::string describe_route_text(const Route& route, std::size_t max_rows) {
  std::string text = summary(route);
  text += "vertices:\n      #      latitude     longitude     AMSL m      AGL m      m/s  item  kind\n";
  append_rows(text, route.vertices.size(), max_rows, [&](std::size_t i) {
    const RouteVertex& vertex = route.vertices[i];
    return pad_left(std::to_string(i + 1), 7) + pad_left(format_fixed(vertex.point.lat_deg, 7), 14) +
           pad_left(format_fixed(vertex.point.lon_deg, 7), 14) + pad_left(number_or_dash(vertex.amsl_m, 1), 11) +
           pad_left(number_or_dash(vertex.agl_m, 1), 11) + pad_left(number_or_dash(vertex.speed_mps, 1), 9) +
           pad_left(vertex.source_item < 0 ? "-" : std::to_string(vertex.source_item), 6) + "  " + vertex.kind;
  });
  text += "legs:\n";
  append_rows(text, route.legs.size(), max_rows, [&](std::size_t i) {
    const RouteLeg& leg = route.legs[i];
    return pad_left(std::to_string(i + 1), 7) + "  " + std::to_string(leg.from + 1) + " to " +
           std::to_string(leg.to + 1) + ", " + format_fixed(leg.length_m, 1) + " m";
  });
  text += "items of the file:\n";
  append_rows(text, route.items.size(), max_rows, [&](std::size_t i) {
    const RouteItem& item = route.items[i];
    return pad_left(std::to_string(item.index), 7) + "  " + item.what + ": " + item.became;
  });
  if (!route.notes.empty()) text += "notes:\n";
  for (const std::string& note : route.notes) text += "  - " + note + "\n";
  return text;
}

}  // namespace pilotage
