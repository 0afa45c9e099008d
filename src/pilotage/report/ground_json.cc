#include "pilotage/report/ground_json.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "pilotage/base/variant_json.h"
#include "pilotage/matchability/matchability_model.h"
#include "pilotage/report/page_text.h"
#include "pilotage/verdict/tile_class.h"

namespace pilotage {
namespace {

/// Whether its P, the measure that ranks, is beyond what P was tested on, and rests on no tile of this ground either.
bool is_untested(const std::vector<GridLevel>& levels, const std::vector<MeasureScale>& measures,
                 const ReportTile& tile) {
  const auto has_p = [&](const MeasureScale& scale) {
    return scale.measure.heat.ranks && std::isfinite(scale.measure.get(tile.score));
  };
  if (std::none_of(measures.begin(), measures.end(), has_p) || tile.score.level_tiles > 0) return false;
  const auto level = std::find_if(levels.begin(), levels.end(),
                                  [&](const GridLevel& one) { return one.matrix.level == tile.tile.level; });
  return level != levels.end() && !is_like_tested(*level);
}

}  // namespace

nlohmann::ordered_json measures_json(const std::vector<MeasureScale>& measures) {
  const auto number = [](double value) { return variant_to_json(number_value(value, 12)); };
  auto json = nlohmann::ordered_json::array();
  for (const MeasureScale& scale : measures) {
    const HeatMap& heat = scale.measure.heat;
    json.push_back({{"name", scale.measure.name},
                    {"label", heat.title},
                    {"unit", heat.unit},
                    {"meaning", heat.meaning},
                    {"low", number(scale.low)},
                    {"high", number(scale.high)},
                    {"least", number(scale.least)},
                    {"most", number(scale.most)}});
  }
  return json;
}

nlohmann::ordered_json tiles_json(const std::vector<TileField>& fields, const std::vector<ReportTile>& tiles) {
  nlohmann::ordered_json json;
  for (const char* key : {"columns", "labels", "units", "rows"}) json[key] = nlohmann::ordered_json::array();
  for (const TileField& field : fields) {
    json["columns"].push_back(field.name);
    json["labels"].push_back(field.label);
    json["units"].push_back(field.unit);
  }
  for (const ReportTile& tile : tiles) {
    auto row = nlohmann::ordered_json::array();
    for (const TileField& field : fields) row.push_back(variant_to_json(field.value(tile)));
    json["rows"].push_back(std::move(row));
  }
  return json;
}

nlohmann::ordered_json plane_line_json(const std::vector<Eigen::Vector2d>& line) {
  auto json = nlohmann::ordered_json::array();
  for (const Eigen::Vector2d& point : line) {
    json.push_back(std::round(point.x() * 10) / 10);
    json.push_back(std::round(point.y() * 10) / 10);
  }
  return json;
}

nlohmann::ordered_json ground_display_json(const ReportDisplay& display, const std::vector<GridLevel>& levels,
                                           const std::vector<ReportTile>& tiles,
                                           const std::vector<MeasureScale>& measures) {
  nlohmann::ordered_json json;
  json["drawn"] = display.drawn;
  json["missing"] = display.missing;
  json["edges_m"] = {display.min_x_m, display.min_y_m, display.max_x_m, display.max_y_m};
  json["imagery"] = display.imagery_jpeg.empty() ? "" : "data:image/jpeg;base64," + base64(display.imagery_jpeg);
  json["pictures"] = display.pictures_jpeg.empty() ? "" : "data:image/jpeg;base64," + base64(display.pictures_jpeg);
  json["picture_side_px"] = display.picture_side_px;
  json["picture_columns"] = display.picture_columns;
  json["cells_m"] = nlohmann::ordered_json::array();
  for (const auto& corners : display.cells_m) {
    json["cells_m"].push_back(plane_line_json({corners.begin(), corners.end()}));
  }
  json["classes"] = nlohmann::ordered_json::array();  // of each tile, null where nothing decides
  for (const ReportTile& tile : tiles) {
    const std::optional<TileClass> known = tile_class(tile.score);
    json["classes"].push_back(known ? nlohmann::ordered_json(static_cast<int>(*known)) : nlohmann::ordered_json());
  }
  json["untested"] = nlohmann::ordered_json::array();  // numbers of the tiles whose P is beyond what it was tested on
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    if (is_untested(levels, measures, tiles[i])) json["untested"].push_back(i);
  }
  json["tested_on"] = tested_on_text();
  json["class_names"] = nlohmann::ordered_json::array();
  json["class_colors"] = nlohmann::ordered_json::array();
  for (const RasterClass& next : tile_classes()) {
    json["class_names"].push_back(next.name);
    json["class_colors"].push_back(hex_color({next.rgb[0], next.rgb[1], next.rgb[2]}));
  }
  json["class_meaning"] = tile_classes_meaning();
  json["shades"] = nlohmann::ordered_json::array();
  json["color_maps"] = nlohmann::ordered_json::array();
  json["decimals"] = nlohmann::ordered_json::array();
  json["ranks"] = nlohmann::ordered_json::array();  // the page can show them from 0 to 1, too
  for (const MeasureScale& scale : measures) {
    nlohmann::ordered_json shades = nlohmann::ordered_json::array();
    for (const ReportTile& tile : tiles) shades.push_back(shade(scale, scale.measure.get(tile.score)));
    json["shades"].push_back(std::move(shades));
    json["color_maps"].push_back(scale.measure.heat.colors == ColorMap::kBlues ? "blues" : "cividis");
    json["decimals"].push_back(scale.measure.heat.decimals);
    json["ranks"].push_back(scale.measure.heat.ranks);
  }
  for (const auto& [name, map] : {std::pair{"blues", ColorMap::kBlues}, std::pair{"cividis", ColorMap::kCividis}}) {
    for (const Rgb color : color_table(map)) json["colors"][name].push_back(hex_color(color));
  }
  return json;
}

}  // namespace pilotage
