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

#include <nlohmann/json.hpp>

#include "pilotage/base/text.h"
#include "pilotage/gis/qgis_style.h"
#include "pilotage/report/sampled_route.h"
#include "pilotage/report/tile_class.h"
#include "pilotage/report/tile_fields.h"
#include "pilotage/report/wording.h"

namespace pilotage {
namespace {

using Corners = std::vector<Eigen::Vector2d>;

constexpr std::size_t kMaxLinePoints = 100'000;
constexpr Rgb kRouteColor{0x20, 0x20, 0x20};
constexpr Rgb kDeniedColor{0x6a, 0x3d, 0x9a};

/// A column of a layer and where its value comes from.
template <class Row>
struct LayerField {
  VectorColumn column;
  VectorValue (*value)(const Row&);
};

template <class Row>
std::vector<VectorColumn> columns_of(const std::vector<LayerField<Row>>& fields) {
  std::vector<VectorColumn> columns;
  for (const LayerField<Row>& field : fields) columns.push_back(field.column);
  return columns;
}

template <class Row>
std::vector<VectorValue> values_of(const std::vector<LayerField<Row>>& fields, const Row& row) {
  std::vector<VectorValue> values;
  for (const LayerField<Row>& field : fields) values.push_back(field.value(row));
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
  return *std::find_if(input.mission.ground.levels.begin(), input.mission.ground.levels.end(),
                       [&](const GridLevel& entry) { return entry.matrix.level == level; });
}

VectorStyle tile_style(const MeasureScale& scale, const std::vector<ScaleClass>& classes, const TileScores& score) {
  const double value = scale.measure.get(score);
  VectorStyle style{"#404040ff", 1, "#80808040"};
  for (const ScaleClass& next : classes) {  // the last that is reached; the first takes what lies below the scale
    if (!std::isnan(value) && (value >= next.low || &next == &classes.front())) {
      style.fill_color = with_opacity(next.color, "b0");
    }
  }
  return style;
}

VectorLayer tile_layer(const ReportInput& input, const Report& report) {
  VectorLayer layer;
  layer.name = "tiles";
  layer.title = "Tiles";
  layer.description = "The ground around the centre of each tile, with every measure of it.";
  layer.shape = VectorShape::kPolygon;
  layer.crs = input.mission.ground.crs;
  layer.visible = false;
  for (const TileField& field : tile_fields()) {
    const std::string unit = field.unit.empty() ? "" : " [" + field.unit + "]";
    layer.columns.push_back({field.name, field.type, field.label + unit});
  }
  const MeasureScale& scale = shown_scale(report);
  const std::vector<ScaleClass> classes = scale_classes(scale);
  layer.qml = qgis_tile_style(scale);
  for (const ReportTile& tile : report.tiles) {
    VectorFeature feature;
    feature.points = cell_of(tile.tile, level_of(input, tile.tile.level).matrix);
    for (const TileField& field : tile_fields()) feature.values.push_back(field.value(tile));
    feature.title = "Tile " + std::to_string(tile.tile.tile_id);
    feature.style = tile_style(scale, classes, tile.score);
    layer.features.push_back(std::move(feature));
  }
  return layer;
}

/// Tiles of a level for which `belongs` holds and that touch along edges, largest group first; of equals the one with
/// the smallest tile_id.
template <class Belongs>
std::vector<std::vector<const ReportTile*>> connected_tiles(const Report& report, const Belongs& belongs) {
  using Cell = std::tuple<int, std::int64_t, std::int64_t>;
  std::map<Cell, const ReportTile*> waiting;
  for (const ReportTile& tile : report.tiles) {
    if (belongs(tile)) waiting[{tile.tile.level, tile.tile.row, tile.tile.column}] = &tile;
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

/// The outline of a group of tiles with its number of them and, where it is known, the range of their P(correct fix):
/// values after the first are its level, tiles, and both ends of that range.
VectorFeature outline_of(const ReportInput& input, const std::vector<const ReportTile*>& group, VectorValue first) {
  std::vector<Corners> cells;
  std::optional<std::pair<double, double>> range;
  for (const ReportTile* tile : group) {
    cells.push_back(cell_of(tile->tile, level_of(input, tile->tile.level).matrix));
    const double p = tile->score.p_correct_fix;
    if (std::isnan(p)) continue;
    range = range ? std::pair(std::min(range->first, p), std::max(range->second, p)) : std::pair(p, p);
  }
  VectorFeature feature = join_polygons(cells);
  feature.note = std::to_string(group.size()) + (group.size() == 1 ? " tile" : " tiles");
  if (range) {
    feature.note += ", P(correct fix) " + number_text(range->first, 2) + " to " + number_text(range->second, 2);
  }
  feature.values = {std::move(first), static_cast<std::int64_t>(group.front()->tile.level),
                    static_cast<std::int64_t>(group.size())};
  for (const bool largest : {false, true}) {
    if (!range) feature.values.emplace_back(std::monostate{});
    if (range) feature.values.push_back(number_value(largest ? range->second : range->first));
  }
  return feature;
}

VectorLayer decision_layer(const ReportInput& input, const Report& report) {
  VectorLayer layer;
  layer.name = "decision";
  layer.title = "Decision: go, marginal, no-go";
  layer.description = "The ground by whether a fix can be counted on there: " + tile_classes_meaning() + ".";
  layer.shape = VectorShape::kPolygon;
  layer.crs = input.mission.ground.crs;
  layer.columns = {{"class", VectorType::kText, "Class"},
                   {"level", VectorType::kInteger, "Level"},
                   {"tiles", VectorType::kInteger, "Tiles"},
                   {"min_p_correct_fix", VectorType::kReal, "Smallest P(correct fix)"},
                   {"max_p_correct_fix", VectorType::kReal, "Largest P(correct fix)"}};
  std::vector<FillClass> fills;
  for (std::size_t i = 0; i < tile_classes().size(); ++i) {
    const RasterClass& known = tile_classes()[i];
    const Rgb color{known.rgb[0], known.rgb[1], known.rgb[2]};
    fills.push_back({known.name, known.name, color});
    const auto is_of_class = [&](const ReportTile& tile) {
      const std::optional<TileClass> found = tile_class(tile.score);
      return found && static_cast<std::size_t>(*found) == i;
    };
    for (const auto& group : connected_tiles(report, is_of_class)) {
      VectorFeature feature = outline_of(input, group, known.name);
      feature.title = known.name;
      feature.style = {with_opacity(color, "ff"), 1, with_opacity(color, "90")};
      layer.features.push_back(std::move(feature));
    }
  }
  layer.qml = qgis_fill_style("class", fills);
  return layer;
}

VectorLayer area_layer(const ReportInput& input, const Report& report) {
  VectorLayer layer;
  layer.name = "areas";
  layer.title = "Matching areas";
  layer.description = "Outlines of the ground over which stored tiles give fixes.";
  layer.shape = VectorShape::kPolygon;
  layer.crs = input.mission.ground.crs;
  layer.columns = {{"area", VectorType::kInteger, "Area"},
                   {"level", VectorType::kInteger, "Level"},
                   {"tiles", VectorType::kInteger, "Tiles"},
                   {"min_p_correct_fix", VectorType::kReal, "Smallest P(correct fix)"},
                   {"max_p_correct_fix", VectorType::kReal, "Largest P(correct fix)"}};
  layer.qml = qgis_outline_style(status_color(QualityStatus::kGood), 0.6);
  std::int64_t number = 0;
  for (const auto& group : connected_tiles(report, [](const ReportTile& tile) { return tile.selected; })) {
    VectorFeature feature = outline_of(input, group, ++number);
    feature.title = "Matching area " + std::to_string(number);
    feature.style = {with_opacity(status_color(QualityStatus::kGood), "ff"), 2, ""};
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

VectorValue item_value(int item) {
  return item < 0 ? VectorValue() : VectorValue(std::int64_t{item});
}

const std::vector<LayerField<ReportLeg>>& leg_fields() {
  using Leg = const ReportLeg&;
  using Type = VectorType;
  static const std::vector<LayerField<ReportLeg>> fields = {
      {{"leg", Type::kInteger, "Leg"}, [](Leg leg) { return VectorValue(std::int64_t{leg.status.leg} + 1); }},
      {{"from_item", Type::kInteger, "Item of the plan where it begins"},
       [](Leg leg) { return item_value(leg.from_item); }},
      {{"to_item", Type::kInteger, "Item of the plan where it ends"}, [](Leg leg) { return item_value(leg.to_item); }},
      {{"status", Type::kText, "Status"}, [](Leg leg) { return VectorValue(std::string(status_name(leg.quality))); }},
      {{"from_distance_m", Type::kReal, "From, along the route [m]"},
       [](Leg leg) { return number_value(leg.from_distance_m); }},
      {{"length_m", Type::kReal, "Length [m]"}, [](Leg leg) { return number_value(leg.status.length_m); }},
      {{"matchable_fraction", Type::kReal, "Share over matching areas"},
       [](Leg leg) { return number_value(leg.status.matchable_fraction); }},
      {{"max_error_m", Type::kReal, "Largest predicted error [m]"},
       [](Leg leg) { return number_value(leg.status.max_error_m); }},
      {{"within_limit", Type::kBoolean, "Error within its limit"},
       [](Leg leg) { return VectorValue(leg.status.within_limit); }},
      {{"p_within_limit", Type::kReal, "P(within the limit)"},
       [](Leg leg) { return number_value(leg.status.p_within_limit); }},
      {{"p_fix", Type::kReal, "P(a correct fix)"}, [](Leg leg) { return number_value(leg.status.p_fix); }}};
  return fields;
}

VectorLayer leg_layer(const ReportInput& input, const Report& report) {
  VectorLayer layer = line_layer("legs", "Legs", "The legs of the route and whether they can be flown.");
  layer.columns = columns_of(leg_fields());
  std::vector<LineClass> classes;
  for (const QualityStatus status : {QualityStatus::kGood, QualityStatus::kMarginal, QualityStatus::kBad}) {
    const std::string value(status_name(status));
    classes.push_back({value, value, status_color(status), 1.2, status != QualityStatus::kGood});
  }
  layer.qml = qgis_line_style("status", classes);
  for (const ReportLeg& leg : report.legs) {
    std::vector<GeodeticPoint> points = leg_line(input.mission.flight.samples, leg.status.leg, kMaxLinePoints);
    points.insert(points.begin(), leg.from);
    points.push_back(leg.to);
    VectorFeature feature;
    feature.points = line_of(points);
    feature.values = values_of(leg_fields(), leg);
    feature.title = "Leg " + std::to_string(leg.status.leg + 1);
    if (leg.from_item >= 0 && leg.to_item >= 0) {
      feature.title += " (items " + std::to_string(leg.from_item) + " to " + std::to_string(leg.to_item) + ")";
    }
    feature.note = std::string(status_name(leg.quality)) + ": predicted error " + error_text(leg.status.max_error_m) +
                   ", within the limit with P " + fixed_or_unknown(leg.status.p_within_limit);
    feature.style = {with_opacity(status_color(leg.quality), "ff"), 4, ""};
    layer.features.push_back(std::move(feature));
  }
  return layer;
}

const std::vector<LayerField<ReportGap>>& gap_fields() {
  using Gap = const ReportGap&;
  using Type = VectorType;
  static const std::vector<LayerField<ReportGap>> fields = {
      {{"leg", Type::kInteger, "Leg on which it starts"},
       [](Gap gap) { return VectorValue(std::int64_t{gap.gap.leg} + 1); }},
      {{"status", Type::kText, "Status"}, [](Gap gap) { return VectorValue(std::string(status_name(gap.quality))); }},
      {{"from_distance_m", Type::kReal, "From, along the route [m]"},
       [](Gap gap) { return number_value(gap.gap.from_distance_m); }},
      {{"to_distance_m", Type::kReal, "To, along the route [m]"},
       [](Gap gap) { return number_value(gap.gap.to_distance_m); }},
      {{"length_m", Type::kReal, "Length [m]"}, [](Gap gap) { return number_value(gap.length_m); }},
      {{"duration_s", Type::kReal, "Duration [s]"}, [](Gap gap) { return number_value(gap.gap.duration_s); }},
      {{"speed_mps", Type::kReal, "Speed [m/s]"}, [](Gap gap) { return number_value(gap.speed_mps); }},
      {{"error_m", Type::kReal, "Predicted error at its end [m]"},
       [](Gap gap) { return number_value(gap.gap.error_m); }},
      {{"within_limit", Type::kBoolean, "Error within its limit"},
       [](Gap gap) { return VectorValue(gap.gap.within_limit); }},
      {{"p_first_excess", Type::kReal, "P(first beyond the limit here)"},
       [](Gap gap) { return number_value(gap.gap.p_first_excess); }}};
  return fields;
}

VectorLayer gap_layer(const ReportInput& input, const Report& report) {
  VectorLayer layer = line_layer("gaps", "Gaps", "Stretches of the route without a fix.");
  layer.columns = columns_of(gap_fields());
  std::vector<LineClass> classes;
  for (const QualityStatus status : {QualityStatus::kGood, QualityStatus::kMarginal, QualityStatus::kBad}) {
    const std::string value(status_name(status));
    classes.push_back({value, "without a fix, " + value, status_color(status), 3, false});
  }
  layer.qml = qgis_line_style("status", classes);
  for (const ReportGap& gap : report.gaps) {
    VectorFeature feature;
    feature.points = line_of(route_line_between(input.mission.flight.samples, gap.gap.from_distance_m,
                                                gap.gap.to_distance_m, kMaxLinePoints));
    feature.values = values_of(gap_fields(), gap);
    feature.title = "Gap of " + length_text(gap.length_m);
    feature.note = std::string(status_name(gap.quality)) + ": " + duration_text(gap.gap.duration_s) + "; " +
                   comparison_text(gap.gap.error_m, report.max_error_m);
    feature.style = {with_opacity(status_color(gap.quality), "80"), 9, ""};  // around the leg
    if (feature.points.size() >= 2) layer.features.push_back(std::move(feature));
  }
  return layer;
}

VectorLayer denied_layer(const ReportInput& input, const Report& report) {
  VectorLayer layer = line_layer("denied", "GNSS denied", "Stretches of the route over which GNSS is denied.");
  layer.columns = {{"from_distance_m", VectorType::kReal, "From, along the route [m]"},
                   {"to_distance_m", VectorType::kReal, "To, along the route [m]"},
                   {"length_m", VectorType::kReal, "Length [m]"}};
  layer.qml = qgis_line_style("", {{"", "GNSS denied", kDeniedColor, 4, false}});
  for (const DeniedStretch& stretch : report.denied) {
    const double length_m = stretch.to_distance_m - stretch.from_distance_m;
    VectorFeature feature;
    feature.points = line_of(route_line_between(input.mission.flight.samples, stretch.from_distance_m,
                                                stretch.to_distance_m, kMaxLinePoints));
    feature.values = {number_value(stretch.from_distance_m), number_value(stretch.to_distance_m),
                      number_value(length_m)};
    feature.title = (report.loss_anywhere ? "GNSS lost for good: " : "GNSS denied: ") + length_text(length_m);
    feature.note = "from " + length_text(stretch.from_distance_m) + " to " + length_text(stretch.to_distance_m) +
                   (report.loss_anywhere ? "; the worst point to lose it" : "");
    feature.style = {with_opacity(kDeniedColor, "60"), 14, ""};  // around the gaps
    if (feature.points.size() >= 2) layer.features.push_back(std::move(feature));
  }
  return layer;
}

const std::vector<LayerField<Report>>& route_fields() {
  using Type = VectorType;
  static const std::vector<LayerField<Report>> fields = {
      {{"name", Type::kText, "Name"}, [](const Report& report) { return VectorValue(report.route_name); }},
      {{"length_m", Type::kReal, "Length [m]"},
       [](const Report& report) { return number_value(report.route_length_m); }},
      {{"matchable_fraction", Type::kReal, "Share over matching areas"},
       [](const Report& report) { return number_value(report.matchable_fraction); }},
      {{"largest_error_m", Type::kReal, "Largest predicted error [m]"},
       [](const Report& report) { return number_value(report.largest_error_m); }},
      {{"max_error_m", Type::kReal, "Limit of the error [m]"},
       [](const Report& report) { return number_value(report.max_error_m); }},
      {{"p_within_limit", Type::kReal, "P(within the limit)"},
       [](const Report& report) {
         return report.probability ? number_value(report.probability->p_within_limit) : VectorValue();
       }},
      {{"verdict_status", Type::kText, "Verdict: status"},
       [](const Report& report) { return VectorValue(std::string(verdict_name(report.verdict))); }},
      {{"verdict_text", Type::kText, "Verdict: text"},
       [](const Report& report) { return VectorValue(report.verdict_text); }},
      {{"verdict_assumptions", Type::kText, "Verdict: what it assumes"},
       [](const Report& report) { return VectorValue(report.assumptions); }}};
  return fields;
}

VectorLayer route_layer(const ReportInput& input, const Report& report) {
  VectorLayer layer = line_layer("route", "Route", "The whole route with its verdict.");
  layer.columns = columns_of(route_fields());
  layer.qml = qgis_line_style("", {{"", "route", kRouteColor, 0.3, false}});
  VectorFeature feature;
  feature.values = values_of(route_fields(), report);
  std::vector<GeodeticPoint> points;
  for (const FlightSample& sample : input.mission.flight.samples) points.push_back(sample.point);
  feature.points = line_of(points);
  if (feature.points.empty()) return layer;
  feature.title = report.route_name.empty() ? "Route" : report.route_name;
  feature.note = report.verdict_text + "; " + report.assumptions;
  feature.style = {with_opacity(kRouteColor, "ff"), 2, ""};
  layer.features.push_back(std::move(feature));
  return layer;
}

VectorLayer key_value_layer(const Report& report) {
  VectorLayer layer;
  layer.name = "report";
  layer.title = "Report";
  layer.description = "The verdict and what the report was made of.";
  layer.columns = {{"key", VectorType::kText, ""}, {"value", VectorType::kText, ""}};
  const auto add = [&](const std::string& key, const std::string& value) {
    VectorFeature row;
    row.values = {key, value};
    layer.features.push_back(std::move(row));
  };
  add("title", report.title);
  add("software_version", report.software_version);
  add("verdict.status", std::string(verdict_name(report.verdict)));
  add("verdict.text", report.verdict_text);
  add("verdict.assumptions", report.assumptions);
  for (const QualityRow& row : report.quality) add("quality." + row.name, row.value);
  add("selection.selected_tiles", std::to_string(report.selected_tiles));
  add("selection.all_tiles", std::to_string(report.tiles.size()));
  add("selection.estimated_bytes", std::to_string(report.estimated_bytes));
  for (std::size_t i = 0; i < report.inputs.size(); ++i) {
    const std::string prefix = "inputs." + std::to_string(i) + ".";
    add(prefix + "role", report.inputs[i].role);
    add(prefix + "name", report.inputs[i].name);
    add(prefix + "date", report.inputs[i].date);
    add(prefix + "digest", report.inputs[i].digest);
  }
  return layer;
}

}  // namespace

const MeasureScale& shown_scale(const Report& report) {
  const auto known = std::find_if(report.measures.begin(), report.measures.end(),
                                  [](const MeasureScale& scale) { return !std::isnan(scale.least); });
  return known == report.measures.end() ? report.measures.front() : *known;
}

VectorLayer waypoint_layer(const ReportInput& input) {
  VectorLayer layer = line_layer("waypoints", "Waypoints", "Points of the plan, by the numbers of its items.");
  layer.shape = VectorShape::kPoint;
  using Type = VectorType;
  layer.columns = {{"item", Type::kInteger, "Item of the plan"},
                   {"kind", Type::kText, "Kind"},
                   {"amsl_m", Type::kReal, "Height above sea level [m]"},
                   {"agl_m", Type::kReal, "Height above ground [m]"},
                   {"speed_mps", Type::kReal, "Speed on the way there [m/s]"}};
  const std::vector<RouteVertex>& vertices = input.mission.flight.route.vertices;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const RouteVertex& vertex = vertices[i];
    const auto is_of_item = [&](std::size_t other) {
      return vertex.source_item >= 0 && vertices[other].source_item == vertex.source_item;
    };
    const bool ends_a_curve = vertex.kind == "spline waypoint";
    const bool repeats = ends_a_curve ? i + 1 < vertices.size() && is_of_item(i + 1) : i > 0 && is_of_item(i - 1);
    if (repeats) continue;
    VectorFeature feature;
    feature.points = {{vertex.point.lon_deg, vertex.point.lat_deg}};
    feature.values = {item_value(vertex.source_item), vertex.kind, number_value(vertex.amsl_m),
                      number_value(vertex.agl_m), number_value(vertex.speed_mps)};
    feature.title = vertex.source_item < 0 ? vertex.kind : std::to_string(vertex.source_item);
    feature.note = vertex.kind;
    layer.features.push_back(std::move(feature));
  }
  return layer;
}

std::vector<const VectorLayer*> drawn_layers(const ReportLayers& layers) {
  std::vector<const VectorLayer*> drawn = {&layers.tiles, &layers.areas, &layers.legs, &layers.gaps};
  if (!layers.denied.features.empty()) drawn.push_back(&layers.denied);
  drawn.push_back(&layers.route);
  return drawn;
}

ReportLayers report_layers(const ReportInput& input, const Report& report) {
  ReportLayers layers{decision_layer(input, report), tile_layer(input, report), area_layer(input, report),
                      leg_layer(input, report),      gap_layer(input, report),  denied_layer(input, report),
                      route_layer(input, report),    key_value_layer(report)};
  for (VectorLayer* layer :
       {&layers.decision, &layers.tiles, &layers.areas, &layers.legs, &layers.gaps, &layers.denied, &layers.route}) {
    std::vector<std::pair<std::string, std::string>> titles;
    for (const VectorColumn& column : layer->columns) titles.emplace_back(column.name, column.title);
    layer->qml = with_aliases(layer->qml, titles);
  }
  return layers;
}

}  // namespace pilotage
