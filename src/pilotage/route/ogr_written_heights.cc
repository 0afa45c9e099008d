#include "pilotage/route/ogr_written_heights.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <nlohmann/json.hpp>

#include "pilotage/base/options_json.h"
#include "pilotage/base/text.h"
#include "pilotage/raster/gdal_xml.h"
#include "pilotage/route/ogr_track.h"

namespace pilotage {
namespace {

using Positions = std::vector<LinePoint>;

/// "16.1,55.2,60 16.2,55.2": nothing when a part is no position.
std::optional<Positions> kml_coordinates(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n";
  Positions positions;
  while (true) {
    text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
    if (text.empty()) return positions;
    const std::string_view tuple = text.substr(0, text.find_first_of(kBlanks));
    text.remove_prefix(tuple.size());
    std::array<std::optional<double>, 3> numbers;
    std::size_t at = 0;
    for (std::size_t i = 0; i < numbers.size() && at < tuple.size(); ++i) {
      const std::size_t end = std::min(tuple.find(',', at), tuple.size());
      numbers[i] = parse_number(tuple.substr(at, end - at));
      at = end + 1;
    }
    if (!numbers[0] || !numbers[1]) return std::nullopt;
    positions.push_back({*numbers[0], *numbers[1]});
    if (numbers[2]) positions.back().z_m = *numbers[2];
  }
}

void collect_kml(const XmlElement& element, std::vector<Positions>& lines) {
  if (element.name == "LineString") {
    if (auto positions = kml_coordinates(element.child_text("coordinates"))) lines.push_back(*std::move(positions));
    return;
  }
  for (const XmlElement& child : element.children) collect_kml(child, lines);
}

/// An array of positions of GeoJSON (RFC 7946, 3.1.1); nothing when it is something else.
std::optional<Positions> json_coordinates(const nlohmann::ordered_json& array) {
  Positions positions;
  for (const auto& position : array) {
    if (!position.is_array() || position.size() < 2 || !position[0].is_number() || !position[1].is_number()) return {};
    LinePoint point{position[0].get<double>(), position[1].get<double>()};
    if (position.size() > 2 && position[2].is_number()) point.z_m = position[2].get<double>();
    positions.push_back(point);
  }
  return positions;
}

/// Lines lie at most two arrays deep in "coordinates".
void collect_json(const nlohmann::ordered_json& value, std::vector<Positions>& lines, int depth = 0) {
  constexpr int kDeepest = 64;
  if (depth > kDeepest || !value.is_structured()) return;
  const auto coordinates = value.is_object() ? value.find("coordinates") : value.end();
  if (coordinates != value.end() && coordinates->is_array()) {
    if (auto line = json_coordinates(*coordinates)) {
      lines.push_back(*std::move(line));
      return;
    }
    for (const auto& part : *coordinates) {
      if (!part.is_array()) continue;
      if (auto line = json_coordinates(part)) lines.push_back(*std::move(line));
    }
    return;
  }
  for (const auto& child : value) collect_json(child, lines, depth + 1);
}

bool lacks_a_height(const Positions& positions) {
  return std::any_of(positions.begin(), positions.end(), [](const LinePoint& point) { return std::isnan(point.z_m); });
}

}  // namespace

void WrittenHeights::read() {
  std::vector<Positions> lines;
  if (format_ == OgrFormat::kKml || format_ == OgrFormat::kKmz) collect_kml(parse_xml(name_, bytes_), lines);
  if (format_ == OgrFormat::kGeoJson) collect_json(parse_json(name_, bytes_), lines);
  lines_.emplace();
  for (Positions& line : lines) {
    if (lacks_a_height(line)) lines_->push_back({std::move(line)});
  }
}

void WrittenHeights::apply(std::vector<LinePoint>& points) {
  if (std::none_of(points.begin(), points.end(), [](const LinePoint& point) { return point.z_m == 0; })) return;
  if (!lines_) read();
  for (WrittenLine& line : *lines_) {
    if (line.taken || !same_positions(points, line.points)) continue;
    line.taken = true;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (std::isnan(line.points[i].z_m)) points[i].z_m = line.points[i].z_m;
    }
    return;
  }
}

}  // namespace pilotage
