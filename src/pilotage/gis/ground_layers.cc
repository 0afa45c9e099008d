#include "pilotage/gis/ground_layers.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "pilotage/base/utf8.h"
#include "pilotage/base/wording.h"
#include "pilotage/gis/qgis_style.h"
#include "pilotage/verdict/tile_class.h"

namespace pilotage {
namespace {

using Corners = std::vector<Eigen::Vector2d>;

constexpr Rgb kLandmarkColor{0x00, 0x00, 0x00};

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

}  // namespace

std::string with_opacity(Rgb color, const char* opacity) {
  return hex_color(color) + opacity;
}

const MeasureScale& shown_scale(const std::vector<MeasureScale>& measures) {
  const auto known = std::find_if(measures.begin(), measures.end(),
                                  [](const MeasureScale& scale) { return !std::isnan(scale.least); });
  return known == measures.end() ? measures.front() : *known;
}

VectorLayer tile_layer(const Ground& ground, const std::vector<ReportTile>& tiles, const std::vector<TileField>& fields,
                       const MeasureScale& scale) {
  VectorLayer layer;
  layer.name = "tiles";
  layer.title = "Tiles";
  layer.description = "The ground around the centre of each tile, with every measure of it.";
  layer.shape = VectorShape::kPolygon;
  layer.crs = ground.crs;
  layer.visible = false;
  for (const TileField& field : fields) {
    const std::string unit = field.unit.empty() ? "" : " [" + field.unit + "]";
    layer.columns.push_back({field.name, field.type, field.label + unit});
  }
  const bool selection =
      std::any_of(fields.begin(), fields.end(), [](const TileField& field) { return field.name == "selected"; });
  const std::vector<ScaleClass> classes = scale_classes(scale);
  layer.qml = qgis_tile_style(scale, selection);
  for (const ReportTile& tile : tiles) {
    VectorFeature feature;
    feature.points = cell_of(tile.tile, ground.level_of(tile.tile).matrix);
    for (const TileField& field : fields) feature.values.push_back(field.value(tile));
    feature.title = "Tile " + std::to_string(tile.tile.tile_id);
    feature.style = tile_style(scale, classes, tile.score);
    layer.features.push_back(std::move(feature));
  }
  return layer;
}

std::vector<std::vector<const ReportTile*>> connected_tiles(const std::vector<ReportTile>& tiles,
                                                            const std::function<bool(const ReportTile&)>& belongs) {
  using Cell = std::tuple<int, std::int64_t, std::int64_t>;
  std::map<Cell, const ReportTile*> waiting;
  for (const ReportTile& tile : tiles) {
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

VectorFeature outline_of(const Ground& ground, const std::vector<const ReportTile*>& group, VectorValue first) {
  std::vector<Corners> cells;
  std::optional<std::pair<double, double>> range;
  for (const ReportTile* tile : group) {
    cells.push_back(cell_of(tile->tile, ground.level_of(tile->tile).matrix));
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

VectorLayer key_value_layer(const std::string& name, const std::string& title, const std::string& description,
                            const std::vector<std::pair<std::string, std::string>>& rows,
                            const std::vector<InputFile>& inputs) {
  VectorLayer layer;
  layer.name = name;
  layer.title = title;
  layer.description = description;
  layer.columns = {{"key", VectorType::kText, ""}, {"value", VectorType::kText, ""}};
  const auto add = [&](const std::string& key, const std::string& value) {
    VectorFeature row;
    row.values = {key, value};
    layer.features.push_back(std::move(row));
  };
  for (const auto& [key, value] : rows) add(key, value);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const std::string prefix = "inputs." + std::to_string(i) + ".";
    add(prefix + "role", inputs[i].role);
    add(prefix + "name", inputs[i].name);
    add(prefix + "date", inputs[i].date);
    add(prefix + "digest", inputs[i].digest);
    if (!inputs[i].licence.terms.empty()) add(prefix + "licence", inputs[i].licence.terms);
    if (!inputs[i].licence.attribution.empty()) add(prefix + "attribution", inputs[i].licence.attribution);
  }
  return layer;
}

VectorLayer decision_layer(const Ground& ground, const std::vector<ReportTile>& tiles) {
  VectorLayer layer;
  layer.name = "decision";
  layer.title = "Decision: go, marginal, no-go";
  layer.description = "The ground by whether a fix can be counted on there: " + tile_classes_meaning() + ".";
  layer.shape = VectorShape::kPolygon;
  layer.crs = ground.crs;
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
    for (const auto& group : connected_tiles(tiles, is_of_class)) {
      VectorFeature feature = outline_of(ground, group, known.name);
      feature.title = known.name;
      feature.style = {with_opacity(color, "ff"), 1, with_opacity(color, "90")};
      layer.features.push_back(std::move(feature));
    }
  }
  layer.qml = qgis_fill_style("class", fills);
  return layer;
}

VectorLayer landmark_layer(const MapLandmarks& landmarks) {
  VectorLayer layer;
  layer.name = "landmarks";
  layer.title = "Landmarks";
  layer.description = "Landmarks that the onboard map may hold, and what their detectors are worth.";
  layer.shape = VectorShape::kPoint;
  layer.crs = Crs::wgs84();
  using Type = VectorType;
  layer.columns = {{"class", Type::kText, "Class"},
                   {"found", Type::kBoolean, "Found on the other date"},
                   {"length_m", Type::kReal, "Length [m]"},
                   {"ambiguity", Type::kReal, "Others expected near it"},
                   {"p_detect", Type::kReal, "P(detect) of its class"},
                   {"false_alarms_per_km2", Type::kReal, "False alarms of its class [1/km²]"},
                   {"sigma_m", Type::kReal, "σ of its class, each axis [m]"}};
  layer.qml = qgis_point_style(kLandmarkColor, 3);
  for (const MapLandmark& landmark : landmarks.landmarks) {
    const MapDetector& detector = landmarks.detectors[landmark.detector];
    VectorFeature feature;
    feature.points = {{landmark.place.lon_deg, landmark.place.lat_deg}};
    feature.values = {valid_utf8(detector.detector.class_name),
                      landmark.found,
                      number_value(landmark.length_m),
                      number_value(landmark.ambiguity),
                      number_value(detector.p_detect),
                      number_value(detector.false_alarms_per_km2),
                      number_value(detector.sigma_m)};
    feature.title = valid_utf8(detector.detector.class_name);
    feature.note = landmark.found ? "found on the other date" : "not found on the other date";
    layer.features.push_back(std::move(feature));
  }
  return layer;
}

}  // namespace pilotage
