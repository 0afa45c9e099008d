#include "pilotage/route/ogr_shapes.h"

#include "testing/error_of.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/route/ogr_areas.h"

namespace pilotage {
namespace {

using testing::error_of;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

constexpr const char* kExtract = R"(<?xml version="1.0" encoding="UTF-8"?>
<osm version="0.6">
 <node id="1" lat="47.0" lon="8.0"/><node id="2" lat="47.0" lon="8.001"/><node id="3" lat="47.001" lon="8.001"/>
 <node id="4" lat="47.01" lon="8.01"><tag k="man_made" v="storage_tank"/><tag k="diameter" v="12"/></node>
 <way id="10"><nd ref="1"/><nd ref="2"/><nd ref="3"/><nd ref="1"/><tag k="building" v="hall"/><tag k="start_date" v="1998"/></way>
 <way id="11"><nd ref="1"/><nd ref="3"/><tag k="highway" v="track"/></way>
</osm>)";

struct ShapeFile {
  std::vector<GeodeticShape> read(const std::string& name, const std::string& text) const {
    write_file(folder / name, text, true);
    return read_shapes(folder / name);
  }
  TemporaryFolder folder;
};

TEST(OgrShapes, OpenStreetMapHasItsTags) {
  const ShapeFile file;
  int points = 0;
  int lines = 0;
  int polygons = 0;
  for (const GeodeticShape& shape : file.read("extract.osm", kExtract)) {
    points += shape.kind == ShapeKind::kPoint;
    lines += shape.kind == ShapeKind::kLine;
    polygons += shape.kind == ShapeKind::kPolygon;
    if (shape.kind == ShapeKind::kPoint) {
      EXPECT_EQ(shape.properties->at("man_made"), "storage_tank");
      EXPECT_EQ(shape.properties->at("diameter"), "12");  // a tag without a field of its own
      EXPECT_DOUBLE_EQ(shape.rings[0][0].lat_deg, 47.01);
    }
    if (shape.kind == ShapeKind::kPolygon) {
      EXPECT_EQ(shape.properties->at("building"), "hall");
      EXPECT_EQ(shape.properties->at("start_date"), "1998");
      EXPECT_EQ(shape.rings[0].size(), 3U);
    }
  }
  EXPECT_EQ(points, 1);
  EXPECT_EQ(lines, 1);
  EXPECT_EQ(polygons, 1);
}

TEST(OgrShapes, PartsOfACollectionAreShapesOfTheirOwn) {
  const ShapeFile file;
  const auto shapes = file.read("shapes.json", R"({"type": "FeatureCollection", "features": [{"type": "Feature",
 "properties": {"class": "a", "nothing": null}, "geometry": {"type": "GeometryCollection", "geometries": [
 {"type": "MultiPoint", "coordinates": [[1, 2], [3, 4]]}, {"type": "LineString", "coordinates": [[0, 0], [1, 1]]}]}}]})");
  ASSERT_EQ(shapes.size(), 3U);
  EXPECT_EQ(shapes[1].rings[0][0].lon_deg, 3);
  EXPECT_EQ(shapes[2].kind, ShapeKind::kLine);
  EXPECT_EQ(*shapes[2].properties, (std::map<std::string, std::string>{{"class", "a"}}));
  EXPECT_THAT(shapes[2].name, HasSubstr("feature 0"));
  EXPECT_THAT(error_of<DataError>([&] { read_areas(file.folder / "shapes.json"); }),
              HasSubstr("holds no polygon, but 3 other shapes"));
}

TEST(OgrShapes, WhatIsNoPlaceIsAProblemOfItsShapeAlone) {
  const ShapeFile file;
  constexpr const char* kOddPoint = R"({"type": "Feature", "properties": {},
 "geometry": {"type": "Point", "coordinates": [594000, 6151000]}})";
  constexpr const char* kSquare =
      R"({"type": "Feature", "properties": {"begun": "2023-05-06", "at": "2023-05-06T07:08:09Z"},
 "geometry": {"type": "Polygon", "coordinates": [[[0, 0], [1, 0], [1, 1], [0, 0]]]}})";
  const auto both = std::string(R"({"type": "FeatureCollection", "features": [)") + kOddPoint + ", " + kSquare + "]}";
  const auto shapes = file.read("shapes.json", both);
  ASSERT_EQ(shapes.size(), 2U);
  EXPECT_EQ(shapes[0].problem, "the corner 594000, 6151000 of a point is no longitude and latitude");
  EXPECT_EQ(shapes[1].problem, "");
  EXPECT_EQ(shapes[1].properties->at("begun"), "2023-05-06") << "whatever GDAL's own way to write dates";
  EXPECT_EQ(shapes[1].properties->at("at"), "2023-05-06");
  EXPECT_EQ(read_areas(file.folder / "shapes.json").size(), 1U);
  EXPECT_THAT(error_of<DataError>([&] { file.read("shapes.txt", "class,x,y"); }),
              HasSubstr("is no file of shapes that is known here"));
}

TEST(OgrShapes, WaysThatLostTheirNodesAreProblems) {
  const ShapeFile file;
  const auto shapes = file.read("cut.osm", R"(<?xml version="1.0"?><osm version="0.6">
 <node id="1" lat="47.0" lon="8.0"/><node id="2" lat="47.0" lon="8.001"/>
 <way id="10"><nd ref="1"/><nd ref="2"/><nd ref="3"/><nd ref="1"/><tag k="building" v="hall"/></way></osm>)");
  for (const GeodeticShape& shape : shapes) EXPECT_NE(shape.problem, "") << shape.name;
}

TEST(OgrShapes, PartsShareWhatTheFileSaysOfThem) {
  const ShapeFile file;
  const auto shapes = file.read("parts.json", R"({"type": "Feature", "properties": {"class": "a"},
 "geometry": {"type": "MultiPoint", "coordinates": [[1, 2], [3, 4]]}})");
  ASSERT_EQ(shapes.size(), 2U);
  EXPECT_EQ(shapes[0].properties, shapes[1].properties);
}

}  // namespace
}  // namespace pilotage
