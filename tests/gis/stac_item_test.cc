#include "pilotage/gis/stac_item.h"

#include <string>

#include "gis/gis_scene.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/output_file.h"
#include "pilotage/gis/report_outputs.h"

// STAC 1.0.0, item-spec/item-spec.md: the fields that an item must have, their types and what they say of each other.
// The official JSON schema lies on the network; this is what it asks of an item without extensions.

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using testing::TemporaryFolder;
using StacJson = nlohmann::ordered_json;

bool is_time(const StacJson& value) {
  return value.is_string() && value.get<std::string>().size() == 20 && value.get<std::string>()[10] == 'T' &&
         value.get<std::string>().ends_with("Z");
}

/// Sentences about what the specification does not allow; empty for an item.
std::vector<std::string> stac_problems(const StacJson& item) {
  std::vector<std::string> problems;
  const auto expect = [&](bool holds, const char* what) {
    if (!holds) problems.emplace_back(what);
  };
  expect(item.value("type", "") == "Feature", "type");
  expect(item.value("stac_version", "") == "1.0.0", "stac_version");
  expect(!item.contains("stac_extensions") || item["stac_extensions"].is_array(), "stac_extensions");
  expect(item.contains("id") && item["id"].is_string() && !item["id"].get<std::string>().empty(), "id");
  expect(item.contains("links") && item["links"].is_array(), "links");
  const auto geometry = item.find("geometry");
  expect(geometry != item.end() && geometry->is_object() && geometry->contains("coordinates"), "geometry");
  const auto box = item.find("bbox");
  expect(box != item.end() && box->is_array() && box->size() == 4 && (*box)[1] < (*box)[3], "bbox");
  const auto properties = item.find("properties");
  expect(properties != item.end() && properties->is_object() && properties->contains("datetime"),
         "properties.datetime");
  if (properties != item.end() && properties->contains("datetime")) {
    const StacJson& time = (*properties)["datetime"];
    const bool range = properties->contains("start_datetime") && properties->contains("end_datetime") &&
                       is_time((*properties)["start_datetime"]) && is_time((*properties)["end_datetime"]) &&
                       (*properties)["start_datetime"] < (*properties)["end_datetime"];
    expect(time.is_null() ? range : is_time(time), "a null datetime needs start_datetime and end_datetime");
  }
  const auto assets = item.find("assets");
  expect(assets != item.end() && assets->is_object(), "assets");
  if (assets == item.end()) return problems;
  for (const auto& [key, asset] : assets->items()) {
    expect(asset.contains("href") && asset["href"].is_string(), "href of an asset");
    expect(!asset.contains("roles") || asset["roles"].is_array(), "roles of an asset");
    expect(!asset.contains("type") || asset["type"].is_string(), "type of an asset");
  }
  return problems;
}

StacJson item_of(const ReportInput& input) {
  return StacJson::parse(stac_item(input, make_report(input), {"map.gpkg", "report.html"}));
}

TEST(StacItem, HoldsWhatTheSpecificationAsksFor) {
  ReportInput input = testing::gis_scene();
  input.mission.ground.imagery.datasets = {{"a.tif", 0.5, "", "2019-08-17", 1, 1},
                                           {"b.tif", 0.5, "", "2020-07-01", 1, 1}};
  const StacJson item = item_of(input);
  EXPECT_THAT(stac_problems(item), ::testing::IsEmpty());
  EXPECT_EQ(item["properties"]["start_datetime"], "2019-08-17T00:00:00Z");
  EXPECT_EQ(item["properties"]["end_datetime"], "2020-07-01T23:59:59Z");
  EXPECT_FALSE(item["properties"].contains("pilotage:imagery_dates"));
  EXPECT_EQ(item["assets"]["map.gpkg"]["href"], "./map.gpkg");
  EXPECT_EQ(item["assets"]["map.gpkg"]["type"], "application/geopackage+sqlite3");
  // The check can fail.
  StacJson wrong = item;
  wrong["properties"].erase("end_datetime");
  EXPECT_THAT(stac_problems(wrong), ::testing::ElementsAre(HasSubstr("null datetime")));
  wrong = item;
  wrong.erase("bbox");
  EXPECT_THAT(stac_problems(wrong), ::testing::ElementsAre("bbox"));
}

TEST(StacItem, TheBoxHoldsEveryTile) {
  const ReportInput input = testing::gis_scene();
  const StacJson box = item_of(input)["bbox"];
  for (const GroundTile& tile : input.mission.ground.tiles) {
    EXPECT_GT(tile.center.lon_deg, box[0].get<double>());
    EXPECT_LT(tile.center.lon_deg, box[2].get<double>());
    EXPECT_GT(tile.center.lat_deg, box[1].get<double>());
    EXPECT_LT(tile.center.lat_deg, box[3].get<double>());
  }
  EXPECT_LT(box[2].get<double>() - box[0].get<double>(), 0.2) << "some kilometres";
}

TEST(StacItem, ABoxOverTheAntimeridianBeginsInTheEast) {
  const StacJson item = item_of(testing::gis_scene({179.988, -16.5}));
  EXPECT_THAT(stac_problems(item), ::testing::IsEmpty());
  EXPECT_EQ(item["geometry"]["type"], "MultiPolygon");
  EXPECT_GT(item["bbox"][0].get<double>(), 179);
  EXPECT_LT(item["bbox"][2].get<double>(), -179);
}

TEST(StacItem, ImageryWithoutADateIsNotGivenOne) {
  ReportInput input = testing::gis_scene();
  input.mission.ground.imagery.datasets = {{"a.tif", 0.5, "", "2019-08-17", 1, 1}, {"b.tif", 0.5, "", "", 1, 1}};
  const StacJson item = item_of(input);
  EXPECT_THAT(stac_problems(item), ::testing::IsEmpty());
  EXPECT_EQ(item["properties"]["pilotage:imagery_dates"], "not said by all of the imagery");
  EXPECT_EQ(item["properties"]["start_datetime"], "1826-01-01T00:00:00Z");
}

// What the item names lies beside it: the files of the formats that were asked for, and the map.
TEST(StacItem, ItsAssetsAreTheFilesBesideIt) {
  const TemporaryFolder folder;
  write_file(folder / "map.gpkg", "a map", false);
  const ReportInput input = testing::gis_scene();
  const auto names = write_report_outputs(folder.path(), "report", input, make_report(input),
                                          {ReportOutput::kHtml, ReportOutput::kRoute, ReportOutput::kStac}, true);
  EXPECT_THAT(names, ::testing::ElementsAre("report.html", "report_route.kml", "report_stac.json"));
  const StacJson item = StacJson::parse(read_file(folder / "report_stac.json"));
  std::vector<std::string> assets;
  for (const auto& [key, asset] : item["assets"].items()) {
    assets.push_back(key);
    EXPECT_TRUE(std::filesystem::exists(folder / asset["href"].get<std::string>())) << key;
  }
  EXPECT_THAT(assets, ::testing::ElementsAre("map.gpkg", "report.html", "report_route.kml"));
}

}  // namespace
}  // namespace pilotage
