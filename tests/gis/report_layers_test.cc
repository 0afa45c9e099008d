#include "pilotage/gis/report_layers.h"

#include <algorithm>
#include <map>
#include <set>

#include "gis/gis_scene.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/geo/geodesic.h"
#include "pilotage/gis/kml_files.h"
#include "pilotage/verdict/tile_class.h"

namespace pilotage {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

ReportLayers layers_of(const ReportInput& input) {
  return report_layers(input, make_report(input));
}

std::size_t column_of(const VectorLayer& layer, const std::string& name) {
  for (std::size_t i = 0; i < layer.columns.size(); ++i) {
    if (layer.columns[i].name == name) return i;
  }
  ADD_FAILURE() << layer.name << " has no column " << name;
  return 0;
}

nlohmann::ordered_json json_of(const VectorValue& value) {
  return std::visit(
      [](const auto& held) -> nlohmann::ordered_json {
        if constexpr (std::is_same_v<std::decay_t<decltype(held)>, std::monostate>) {
          return nullptr;
        } else {
          return held;
        }
      },
      value);
}

TEST(ReportLayers, TilesHoldTheNumbersOfTheReport) {
  const ReportInput input = testing::gis_scene();
  const auto json = report_json(input);
  const VectorLayer tiles = layers_of(input).tiles;
  ASSERT_EQ(tiles.columns.size(), json["tiles"]["columns"].size());
  ASSERT_EQ(tiles.features.size(), json["tiles"]["rows"].size());
  for (std::size_t row = 0; row < tiles.features.size(); ++row) {
    for (std::size_t c = 0; c < tiles.columns.size(); ++c) {
      EXPECT_EQ(tiles.columns[c].name, json["tiles"]["columns"][c]);
      EXPECT_EQ(json_of(tiles.features[row].values[c]), json["tiles"]["rows"][row][c]) << row << " " << c;
    }
  }
}

TEST(ReportLayers, CellsOfALevelTouchWithoutOverlap) {
  const ReportInput input = testing::gis_scene({7.6, 51.96}, false);
  const VectorLayer tiles = layers_of(input).tiles;
  std::vector<std::vector<Eigen::Vector2d>> cells;
  std::set<std::pair<double, double>> corners;
  for (const VectorFeature& feature : tiles.features) {
    ASSERT_EQ(feature.points.size(), 4u);
    cells.push_back(feature.points);
    for (const Eigen::Vector2d& point : feature.points) corners.emplace(point.x(), point.y());
  }
  EXPECT_EQ(corners.size(), 8u * 15u);  // 7 × 14 cells share their corners exactly
  EXPECT_EQ(join_polygons(cells).holes.size(), 0u);
}

TEST(ReportLayers, LegsAndGapsHoldTheNumbersOfTheReport) {
  const ReportInput input = testing::gis_scene();
  const auto json = report_json(input);
  const ReportLayers layers = layers_of(input);
  ASSERT_EQ(layers.legs.features.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t c = 0; c < layers.legs.columns.size(); ++c) {
      EXPECT_EQ(json_of(layers.legs.features[i].values[c]), json["route"]["legs"][i][layers.legs.columns[c].name]);
    }
    EXPECT_EQ(layers.legs.features[i].points.front().x(), input.mission.flight.route.vertices[i].point.lon_deg);
    EXPECT_EQ(layers.legs.features[i].title, "Leg " + std::to_string(i + 1));
    EXPECT_EQ(json_of(layers.legs.features[i].values[column_of(layers.legs, "leg")]), i + 1);
  }
  ASSERT_EQ(layers.gaps.features.size(), 1u);
  EXPECT_EQ(json_of(layers.gaps.features[0].values[column_of(layers.gaps, "error_m")]),
            json["route"]["gaps"][0]["error_m"]);
  EXPECT_EQ(json_of(layers.gaps.features[0].values[column_of(layers.gaps, "leg")]), json["route"]["gaps"][0]["leg"]);
  EXPECT_EQ(json_of(layers.gaps.features[0].values[column_of(layers.gaps, "status")]),
            json["route"]["gaps"][0]["status"]);
  ASSERT_EQ(layers.route.features.size(), 1u);
  EXPECT_EQ(json_of(layers.route.features[0].values[column_of(layers.route, "p_within_limit")]), 0.93);
  EXPECT_EQ(json_of(layers.route.features[0].values[column_of(layers.route, "verdict_status")]),
            json["verdict"]["status"]);
  EXPECT_EQ(json_of(layers.route.features[0].values[column_of(layers.route, "verdict_assumptions")]),
            json["verdict"]["assumptions"]);
}

TEST(ReportLayers, LegsNameTheItemsOfThePlan) {
  ReportInput input = testing::gis_scene();
  EXPECT_TRUE(report_json(input)["route"]["legs"][1]["from_item"].is_null()) << "the file has no mission items";
  Route& route = input.mission.flight.route;
  for (int i = 0; i < 5; ++i) {
    route.items.push_back({i, 16, "waypoint", "vertex"});
    route.vertices[static_cast<std::size_t>(i)].source_item = i == 0 ? -1 : 10 * i;
  }
  const auto legs = report_json(input)["route"]["legs"];
  EXPECT_TRUE(legs[0]["from_item"].is_null()) << "home";
  EXPECT_EQ(legs[1]["from_item"], 10);
  EXPECT_EQ(legs[1]["to_item"], 20);
  EXPECT_EQ(layers_of(input).legs.features[1].title, "Leg 2 (items 10 to 20)");
  EXPECT_THAT(report_html(input), ContainsRegex("Leg 2</th><td[^>]*>10 → 20</td>"));
}

TEST(ReportLayers, ALegThatLosesTheFlightIsNowhereGood) {  // 2026-11: good, and blue, with P = 0
  ReportInput input = testing::gis_scene();
  input.selection.legs[0].p_within_limit = 0;
  const ReportLayers layers = layers_of(input);
  EXPECT_EQ(json_of(layers.legs.features[0].values[column_of(layers.legs, "status")]), "bad");
  EXPECT_THAT(layers.legs.features[0].note, ::testing::StartsWith("bad: "));
  EXPECT_EQ(layers.legs.features[0].style.line_color, "#d5008aff");
  EXPECT_EQ(report_json(input)["route"]["legs"][0]["status"], "bad");
}

TEST(ReportLayers, AreasJoinSelectedTilesThatTouch) {
  ReportInput input = testing::gis_scene({7.6, 51.96}, false);
  // A ring of eight cells around one that is not selected, and one that touches the ring at a corner only.
  const auto id = [](std::int64_t column, std::int64_t row) { return row * 7 + column; };
  input.selection.tile_ids.clear();
  for (std::int64_t row = 0; row < 3; ++row) {
    for (std::int64_t column = 0; column < 3; ++column) {
      if (row != 1 || column != 1) input.selection.tile_ids.push_back(id(column, row));
    }
  }
  input.selection.tile_ids.push_back(id(3, 3));
  const VectorLayer areas = layers_of(input).areas;
  ASSERT_EQ(areas.features.size(), 2u);
  EXPECT_EQ(json_of(areas.features[0].values[column_of(areas, "tiles")]), 8);
  EXPECT_EQ(areas.features[0].holes.size(), 1u);
  EXPECT_EQ(json_of(areas.features[1].values[column_of(areas, "tiles")]), 1);
  EXPECT_EQ(areas.features[1].title, "Matching area 2");
}

// What the class raster says of each tile, as outlines of the classes' colours; together they are all classed tiles.
TEST(ReportLayers, TheDecisionIsTheClassesOfTheTiles) {
  const ReportInput input = testing::gis_scene({7.6, 51.96}, false);
  const VectorLayer decision = layers_of(input).decision;
  std::map<std::string, std::int64_t> tiles;
  for (const VectorFeature& feature : decision.features) {
    const std::string name = std::get<std::string>(feature.values[column_of(decision, "class")]);
    tiles[name] += std::get<std::int64_t>(feature.values[column_of(decision, "tiles")]);
    const auto known = std::find_if(tile_classes().begin(), tile_classes().end(),
                                    [&](const RasterClass& next) { return next.name == name; });
    ASSERT_NE(known, tile_classes().end()) << name;
    const Rgb color{known->rgb[0], known->rgb[1], known->rgb[2]};
    EXPECT_EQ(feature.style.fill_color.substr(0, 7), hex_color(color));
    EXPECT_THAT(decision.qml, ::testing::HasSubstr("label=\"" + name + "\""));
  }
  std::map<std::string, std::int64_t> expected;
  for (const TileScores& score : input.scores) {
    if (const auto found = tile_class(score)) ++expected[tile_classes()[static_cast<std::size_t>(*found)].name];
  }
  EXPECT_EQ(tiles, expected);
  EXPECT_GE(expected.size(), 2U);
}

TEST(ReportLayers, AnEmptyPlanHasEmptyLayers) {
  ReportInput input = testing::gis_scene();
  input.mission.ground.tiles.clear();
  input.mission.flight.places.clear();
  input.scores.clear();
  input.selection = {};
  input.mission.flight.route = {};
  input.mission.flight.samples.clear();
  const ReportLayers layers = layers_of(input);
  EXPECT_TRUE(layers.tiles.features.empty());
  EXPECT_TRUE(layers.areas.features.empty());
  EXPECT_TRUE(layers.decision.features.empty());
  EXPECT_TRUE(layers.route.features.empty());
  EXPECT_FALSE(layers.report.features.empty());
}

// QGroundControl takes a file that holds a polygon for polygons, and the first line of one that holds none.
TEST(KmlFiles, LinesAndAreasStandInFilesOfTheirOwn) {
  const ReportInput input = testing::gis_scene();
  const Report report = make_report(input);
  const ReportLayers layers = layers_of(input);
  const std::string legs = legs_kml(report, layers);
  EXPECT_THAT(legs, Not(HasSubstr("<Polygon")));
  EXPECT_THAT(legs, Not(HasSubstr("<Point")));
  const auto first_line = legs.find("<LineString");
  ASSERT_NE(first_line, std::string::npos);
  EXPECT_LT(legs.find("<Folder id=\"route\""), first_line);
  EXPECT_GT(legs.find("<Folder id=\"legs\""), first_line);
  EXPECT_THAT(legs, HasSubstr("<color>ffb27200</color>"));  // #0072b2 as KML writes it: opacity, blue, green, red
  const std::string areas = areas_kml(report, layers);
  EXPECT_THAT(areas, HasSubstr("<Polygon"));
  EXPECT_THAT(areas, Not(HasSubstr("<LineString")));
}

}  // namespace
}  // namespace pilotage
