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
#include "pilotage/base/utf8.h"
#include "pilotage/base/wording.h"
#include "pilotage/gis/ground_layers.h"
#include "pilotage/gis/qgis_style.h"
#include "pilotage/mapdb/map_landmarks.h"
#include "pilotage/report/sampled_route.h"
#include "pilotage/report/tile_fields.h"
#include "pilotage/verdict/tile_class.h"

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
  for (const auto& group : connected_tiles(report.tiles, [](const ReportTile& tile) { return tile.selected; })) {
    VectorFeature feature = outline_of(input.mission.ground, group, ++number);
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

VectorLayer report_table(const Report& report) {
  std::vector<std::pair<std::string, std::string>> rows = {
      {"title", report.title},
      {"software_version", report.software_version},
      {"verdict.status", std::string(verdict_name(report.verdict))},
      {"verdict.text", report.verdict_text},
      {"verdict.assumptions", report.assumptions}};
  for (const QualityRow& row : report.quality) rows.emplace_back("quality." + row.name, row.value);
  rows.emplace_back("selection.selected_tiles", std::to_string(report.selected_tiles));
  rows.emplace_back("selection.all_tiles", std::to_string(report.tiles.size()));
  rows.emplace_back("selection.estimated_bytes", std::to_string(report.estimated_bytes));
  return key_value_layer("report", "Report", "The verdict and what the report was made of.", rows, report.inputs);
}

}  // namespace

VectorLayer waypoint_layer(const Report& report) {
  VectorLayer layer = line_layer("waypoints", "Waypoints", "Points of the plan, by the numbers of its items.");
  layer.shape = VectorShape::kPoint;
  using Type = VectorType;
  layer.columns = {{"item", Type::kInteger, "Item of the plan"},
                   {"kind", Type::kText, "Kind"},
                   {"amsl_m", Type::kReal, "Height above sea level [m]"},
                   {"agl_m", Type::kReal, "Height above ground [m]"},
                   {"speed_mps", Type::kReal, "Speed on the way there [m/s]"},
                   {"distance_m", Type::kReal, "Along the route [m]"},
                   {"time_s", Type::kReal, "Time since the start [s]"}};
  for (std::size_t i = 0; i < std::min(report.waypoints.size(), kMostWaypointsListed); ++i) {
    const Waypoint& next = report.waypoints[i];
    VectorFeature feature;
    feature.points = {{next.point.lon_deg, next.point.lat_deg}};
    feature.values = {item_value(next.item),        next.kind,
                      number_value(next.amsl_m),    number_value(next.agl_m),
                      number_value(next.speed_mps), number_value(next.distance_m),
                      number_value(next.time_s)};
    feature.title = next.item >= 0 ? std::to_string(next.item) : next.kind;
    feature.note = next.kind;
    layer.features.push_back(std::move(feature));
  }
  return layer;
}

std::vector<const VectorLayer*> drawn_layers(const ReportLayers& layers) {
  std::vector<const VectorLayer*> drawn = {&layers.tiles, &layers.areas, &layers.legs, &layers.gaps};
  for (const VectorLayer* layer : {&layers.denied, &layers.landmarks}) {
    if (!layer->features.empty()) drawn.push_back(layer);
  }
  drawn.push_back(&layers.route);
  return drawn;
}

ReportLayers report_layers(const ReportInput& input, const Report& report) {
  ReportLayers layers{decision_layer(input.mission.ground, report.tiles),
                      tile_layer(input.mission.ground, report.tiles, tile_fields(report.landmarks.has_value()),
                                 shown_scale(report.measures)),
                      area_layer(input, report),
                      leg_layer(input, report),
                      gap_layer(input, report),
                      denied_layer(input, report),
                      landmark_layer(input.landmarks ? *input.landmarks : MapLandmarks()),
                      route_layer(input, report),
                      report_table(report)};
  for (VectorLayer* layer : {&layers.decision, &layers.tiles, &layers.areas, &layers.legs, &layers.gaps, &layers.denied,
                             &layers.landmarks, &layers.route}) {
    std::vector<std::pair<std::string, std::string>> titles;
    for (const VectorColumn& column : layer->columns) titles.emplace_back(column.name, column.title);
    layer->qml = with_aliases(layer->qml, titles);
  }
  return layers;
}

}  // namespace pilotage
