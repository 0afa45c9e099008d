#include "pilotage/gis/report_layers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "pilotage/base/text.h"
#include "pilotage/gis/qgis_style.h"
#include "pilotage/gis/tile_class.h"
#include "pilotage/report/route_line.h"
#include "pilotage/report/tile_fields.h"
#include "pilotage/report/wording.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;
using Corners = std::vector<Eigen::Vector2d>;

constexpr std::size_t kMaxLinePoints = 100'000;
constexpr Rgb kRouteColor{0x20, 0x20, 0x20};

VectorValue value_of(const Json& json, VectorType type) {
  if (json.is_null()) return std::monostate{};
  if (type == VectorType::kBoolean) return json.get<bool>();
  if (type == VectorType::kText) return json.get<std::string>();
  if (type == VectorType::kInteger) return json.get<std::int64_t>();
  return json.get<double>();
}

/// The values of an object by the names of the columns.
std::vector<VectorValue> values_of(const Json& object, const std::vector<VectorColumn>& columns) {
  std::vector<VectorValue> values;
  for (const VectorColumn& column : columns) values.push_back(value_of(object.at(column.name), column.type));
  return values;
}

std::string with_opacity(Rgb color, const char* opacity) {
  return hex_color(color) + opacity;
}

/// The stride-sized cell around a tile's centre, as on the page and in the score raster. Millimetres are the grid on
/// which neighbours have the same corners.
Corners cell_of(const GroundTile& tile, const TileMatrix& matrix) {
  const double share = std::min(1.0, static_cast<double>(matrix.stride_px) / std::max(1, matrix.tile_size_px));
  const Eigen::Vector2d center = tile.bounds.center_m();
  const Eigen::Vector2d half = Eigen::Vector2d(tile.bounds.width_m(), tile.bounds.height_m()) * share / 2;
  const auto corner = [&](double right, double up) -> Eigen::Vector2d {
    return ((center + Eigen::Vector2d(right * half.x(), up * half.y())) * 1000).array().round().matrix() / 1000;
  };
  return {corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)};
}

const GridLevel& level_of(const ReportInput& input, int level) {
  return *std::find_if(input.plan.ground.levels.begin(), input.plan.ground.levels.end(),
                       [&](const GridLevel& entry) { return entry.matrix.level == level; });
}

VectorStyle tile_style(const MeasureScale& scale, const std::vector<ScaleClass>& classes, const TileScore& score) {
  const double value = scale.measure.value(score);
  VectorStyle style{"#404040ff", 1, "#80808040"};
  for (const ScaleClass& next : classes) {  // the last that is reached; the first takes what lies below the scale
    if (!std::isnan(value) && (value >= next.low || &next == &classes.front())) {
      style.fill_color = with_opacity(next.color, "b0");
    }
  }
  return style;
}

VectorType type_of(const TileField& field) {
  const Json value = field.value(ReportTile{});
  if (value.is_boolean()) return VectorType::kBoolean;
  if (value.is_string()) return VectorType::kText;
  return value.is_number_integer() ? VectorType::kInteger : VectorType::kReal;
}

VectorLayer tile_layer(const ReportInput& input, const Report& report, const Json& numbers) {
  VectorLayer layer;
  layer.name = "tiles";
  layer.title = "Tiles";
  layer.description = "The ground around the centre of each tile, with every measure of it.";
  layer.shape = VectorShape::kPolygon;
  layer.crs = input.plan.ground.crs;
  layer.visible = false;
  for (const TileField& field : tile_fields()) {
    const std::string unit = field.unit.empty() ? "" : " [" + std::string(field.unit) + "]";
    layer.columns.push_back({std::string(field.name), type_of(field), std::string(field.label) + unit});
  }
  const MeasureScale& scale = shown_scale(report);
  const std::vector<ScaleClass> classes = scale_classes(scale);
  layer.qml = qgis_tile_style(scale);
  const Json& rows = numbers.at("tiles").at("rows");
  for (std::size_t i = 0; i < report.tiles.size(); ++i) {
    const ReportTile& tile = report.tiles[i];
    VectorFeature feature;
    feature.points = cell_of(tile.tile, level_of(input, tile.tile.level).matrix);
    for (std::size_t c = 0; c < layer.columns.size(); ++c) {
      feature.values.push_back(value_of(rows.at(i).at(c), layer.columns[c].type));
    }
    feature.title = "Tile " + std::to_string(tile.tile.tile_id);
    feature.style = tile_style(scale, classes, tile.score);
    layer.features.push_back(std::move(feature));
  }
  return layer;
}

/// Tiles of a level that touch along edges, largest group first; of equals the one with the smallest tile_id.
std::vector<std::vector<const ReportTile*>> connected_tiles(const Report& report) {
  using Cell = std::tuple<int, std::int64_t, std::int64_t>;
  std::map<Cell, const ReportTile*> waiting;
  for (const ReportTile& tile : report.tiles) {
    if (tile.selected) waiting[{tile.tile.level, tile.tile.row, tile.tile.column}] = &tile;
  }
  std::vector<std::vector<const ReportTile*>> groups;
  while (!waiting.empty()) {
    std::vector<const ReportTile*> group;
    std::vector<Cell> reached{waiting.begin()->first};
    while (!reached.empty()) {
      const auto [level, row, column] = reached.back();
      reached.pop_back();
      const auto found = waiting.extract({level, row, column});
      if (found.empty()) continue;
      group.push_back(found.mapped());
      for (const auto& [down, right] : {std::pair(-1, 0), std::pair(1, 0), std::pair(0, -1), std::pair(0, 1)}) {
        reached.push_back({level, row + down, column + right});
      }
    }
    groups.push_back(std::move(group));
  }
  std::stable_sort(groups.begin(), groups.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
  return groups;
}

VectorLayer area_layer(const ReportInput& input, const Report& report) {
  VectorLayer layer;
  layer.name = "areas";
  layer.title = "Matching areas";
  layer.description = "Outlines of the ground over which stored tiles give fixes.";
  layer.shape = VectorShape::kPolygon;
  layer.crs = input.plan.ground.crs;
  layer.columns = {{"area", VectorType::kInteger, "Area"},
                   {"level", VectorType::kInteger, "Level"},
                   {"tiles", VectorType::kInteger, "Tiles"},
                   {"min_p_correct_fix", VectorType::kReal, "Smallest P(correct fix)"},
                   {"max_p_correct_fix", VectorType::kReal, "Largest P(correct fix)"}};
  layer.qml = qgis_outline_style(status_color(QualityStatus::kGood), 0.6);
  std::int64_t number = 0;
  for (const auto& group : connected_tiles(report)) {
    std::vector<Corners> cells;
    std::optional<std::pair<double, double>> range;
    for (const ReportTile* tile : group) {
      cells.push_back(cell_of(tile->tile, level_of(input, tile->tile.level).matrix));
      const double p = tile->score.p_correct_fix;
      if (std::isnan(p)) continue;
      range = range ? std::pair(std::min(range->first, p), std::max(range->second, p)) : std::pair(p, p);
    }
    VectorFeature feature = join_polygons(cells);
    feature.title = "Matching area " + std::to_string(++number);
    feature.note = std::to_string(group.size()) + (group.size() == 1 ? " tile" : " tiles");
    if (range) {
      feature.note += ", P(correct fix) " + number_text(range->first, 2) + " to " + number_text(range->second, 2);
    }
    feature.style = {with_opacity(status_color(QualityStatus::kGood), "ff"), 2,
                     with_opacity(status_color(QualityStatus::kGood), "30")};
    feature.values = {number, static_cast<std::int64_t>(group.front()->tile.level),
                      static_cast<std::int64_t>(group.size())};
    for (const bool largest : {false, true}) {
      if (!range) feature.values.emplace_back(std::monostate{});
      if (range)
        feature.values.push_back(value_of(rounded(largest ? range->second : range->first, 6), VectorType::kReal));
    }
    layer.features.push_back(std::move(feature));
  }
  return layer;
}

/// Points in degrees without repetitions; one that stands still is a line of two equal points.
Corners line_of(const std::vector<GeodeticPoint>& points) {
  Corners line;
  for (const GeodeticPoint& point : points) {
    const Eigen::Vector2d next(point.lon_deg, point.lat_deg);
    if (line.empty() || next != line.back()) line.push_back(next);
  }
  if (line.size() == 1) line.push_back(line.front());
  return line;
}

VectorLayer line_layer(const std::string& name, const std::string& title, const std::string& description) {
  VectorLayer layer;
  layer.name = name;
  layer.title = title;
  layer.description = description;
  layer.shape = VectorShape::kLine;
  layer.crs = Crs::wgs84();
  return layer;
}

std::string fixed_or_unknown(double p) {
  return std::isnan(p) ? "not known" : probability_text(p);
}

VectorLayer leg_layer(const ReportInput& input, const Report& report, const Json& numbers) {
  VectorLayer layer = line_layer("legs", "Legs", "The legs of the route and whether they can be flown.");
  layer.columns = {{"leg", VectorType::kInteger, "Leg"},
                   {"status", VectorType::kText, "Status"},
                   {"from_distance_m", VectorType::kReal, "From, along the route [m]"},
                   {"length_m", VectorType::kReal, "Length [m]"},
                   {"matchable_fraction", VectorType::kReal, "Share over matching areas"},
                   {"max_error_m", VectorType::kReal, "Largest predicted error [m]"},
                   {"within_limit", VectorType::kBoolean, "Error within its limit"},
                   {"p_within_limit", VectorType::kReal, "P(within the limit)"},
                   {"p_fix", VectorType::kReal, "P(a correct fix)"}};
  std::vector<LineClass> classes;
  for (const QualityStatus status : {QualityStatus::kGood, QualityStatus::kMarginal, QualityStatus::kBad}) {
    const std::string value(status_name(status));
    classes.push_back({value, value, status_color(status), 1.2, status != QualityStatus::kGood});
  }
  layer.qml = qgis_line_style("status", classes);
  const Json& legs = numbers.at("route").at("legs");
  for (std::size_t i = 0; i < report.legs.size(); ++i) {
    const ReportLeg& leg = report.legs[i];
    std::vector<GeodeticPoint> points = leg_line(input.plan.flight.samples, leg.status.leg, kMaxLinePoints);
    points.insert(points.begin(), leg.from);
    points.push_back(leg.to);
    VectorFeature feature;
    feature.points = line_of(points);
    feature.values = values_of(legs.at(i), layer.columns);
    feature.title = "Leg " + std::to_string(leg.status.leg);
    feature.note = std::string(status_name(leg.quality)) + ": predicted error " + error_text(leg.status.max_error_m) +
                   ", within the limit with P " + fixed_or_unknown(leg.status.p_within_limit);
    feature.style = {with_opacity(status_color(leg.quality), "ff"), 4, ""};
    layer.features.push_back(std::move(feature));
  }
  return layer;
}

VectorLayer gap_layer(const ReportInput& input, const Report& report, const Json& numbers) {
  VectorLayer layer = line_layer("gaps", "Gaps", "Stretches of the route without a fix.");
  layer.columns = {{"leg", VectorType::kInteger, "Leg on which it starts"},
                   {"from_distance_m", VectorType::kReal, "From, along the route [m]"},
                   {"to_distance_m", VectorType::kReal, "To, along the route [m]"},
                   {"length_m", VectorType::kReal, "Length [m]"},
                   {"duration_s", VectorType::kReal, "Duration [s]"},
                   {"speed_mps", VectorType::kReal, "Speed [m/s]"},
                   {"error_m", VectorType::kReal, "Predicted error at its end [m]"},
                   {"within_limit", VectorType::kBoolean, "Error within its limit"},
                   {"p_first_excess", VectorType::kReal, "P(first beyond the limit here)"}};
  layer.qml = qgis_line_style("", {{"", "gap", status_color(QualityStatus::kBad), 3, false}});
  const Json& gaps = numbers.at("route").at("gaps");
  for (std::size_t i = 0; i < report.gaps.size(); ++i) {
    const ReportGap& gap = report.gaps[i];
    VectorFeature feature;
    feature.points = line_of(
        route_line_between(input.plan.flight.samples, gap.gap.from_distance_m, gap.gap.to_distance_m, kMaxLinePoints));
    feature.values = values_of(gaps.at(i), layer.columns);
    feature.title = "Gap of " + length_text(gap.length_m);
    feature.note = duration_text(gap.gap.duration_s) + "; " + comparison_text(gap.gap.error_m, report.max_error_m);
    feature.style = {with_opacity(status_color(QualityStatus::kBad), "80"), 9, ""};  // around the leg
    if (feature.points.size() >= 2) layer.features.push_back(std::move(feature));
  }
  return layer;
}

VectorLayer route_layer(const ReportInput& input, const Report& report, const Json& numbers) {
  VectorLayer layer = line_layer("route", "Route", "The whole route with its verdict.");
  layer.columns = {{"name", VectorType::kText, "Name"},
                   {"length_m", VectorType::kReal, "Length [m]"},
                   {"matchable_fraction", VectorType::kReal, "Share over matching areas"},
                   {"largest_error_m", VectorType::kReal, "Largest predicted error [m]"},
                   {"max_error_m", VectorType::kReal, "Limit of the error [m]"}};
  layer.qml = qgis_line_style("", {{"", "route", kRouteColor, 0.3, false}});
  const Json& route = numbers.at("route");
  VectorFeature feature;
  feature.values = values_of(route, layer.columns);
  const Json& probability = route.at("probability");
  layer.columns.push_back({"p_within_limit", VectorType::kReal, "P(within the limit)"});
  feature.values.push_back(probability.is_null() ? VectorValue()
                                                 : value_of(probability.at("p_within_limit"), VectorType::kReal));
  for (const char* key : {"status", "text"}) {
    layer.columns.push_back({std::string("verdict_") + key, VectorType::kText, std::string("Verdict: ") + key});
    feature.values.push_back(value_of(numbers.at("verdict").at(key), VectorType::kText));
  }
  std::vector<GeodeticPoint> points;
  for (const FlightSample& sample : input.plan.flight.samples) points.push_back(sample.point);
  feature.points = line_of(points);
  if (feature.points.empty()) return layer;
  feature.title = report.route_name.empty() ? "Route" : report.route_name;
  feature.note = report.verdict_text;
  feature.style = {with_opacity(kRouteColor, "ff"), 2, ""};
  layer.features.push_back(std::move(feature));
  return layer;
}

VectorLayer key_value_layer(const Json& numbers) {
  VectorLayer layer;
  layer.name = "report";
  layer.title = "Report";
  layer.description = "The verdict and what the report was made of.";
  layer.columns = {{"key", VectorType::kText, ""}, {"value", VectorType::kText, ""}};
  const auto add = [&](const std::string& key, const Json& value) {
    VectorFeature row;
    row.values = {key, value.is_string() ? value.get<std::string>() : value.dump()};
    layer.features.push_back(std::move(row));
  };
  for (const char* key : {"title", "software_version"}) add(key, numbers.at(key));
  for (const auto& [key, value] : numbers.at("verdict").items()) add("verdict." + key, value);
  for (const Json& row : numbers.at("quality")) {
    add("quality." + row.at("name").get<std::string>(), row.at("value"));
  }
  for (const auto& [key, value] : numbers.at("selection").items()) add("selection." + key, value);
  for (std::size_t i = 0; i < numbers.at("inputs").size(); ++i) {
    for (const auto& [key, value] : numbers.at("inputs").at(i).items()) {
      add("inputs." + std::to_string(i) + "." + key, value);
    }
  }
  return layer;
}

}  // namespace

const MeasureScale& shown_scale(const Report& report) {
  const auto known = std::find_if(report.measures.begin(), report.measures.end(),
                                  [](const MeasureScale& scale) { return !std::isnan(scale.least); });
  return known == report.measures.end() ? report.measures.front() : *known;
}

ReportLayers report_layers(const ReportInput& input, const Report& report, const Json& numbers) {
  ReportLayers layers{tile_layer(input, report, numbers),  area_layer(input, report),
                      leg_layer(input, report, numbers),   gap_layer(input, report, numbers),
                      route_layer(input, report, numbers), key_value_layer(numbers)};
  for (VectorLayer* layer : {&layers.tiles, &layers.areas, &layers.legs, &layers.gaps, &layers.route}) {
    std::vector<std::pair<std::string, std::string>> titles;
    for (const VectorColumn& column : layer->columns) titles.emplace_back(column.name, column.title);
    layer->qml = with_aliases(layer->qml, titles);
  }
  return layers;
}

}  // namespace pilotage
