#include "pilotage/route/ogr_route.h"

#include <cmath>
#include <cstdlib>
#include <map>

#include "route/route_files.h"
#include "testing/forged_map.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/output_file.h"
#include "pilotage/mapdb/sqlite.h"
#include "pilotage/raster/gdal_vector.h"

namespace pilotage {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using testing::route_error;
using testing::route_file;
using testing::route_file_error;

RouteOptions choose(const std::string& feature, HeightReference heights = HeightReference::kAuto) {
  RouteOptions options;
  options.feature = feature;
  options.height_reference = heights;
  return options;
}

std::string line_geojson(const std::string& coordinates) {
  return R"({"type": "LineString", "coordinates": )" + coordinates + "}";
}

TEST(OgrRoute, SeveralLinesNeedAChoice) {
  const std::string error = route_file_error(route_file("track.gpx"));
  EXPECT_THAT(error, HasSubstr("has 2 lines"));
  EXPECT_THAT(error, HasSubstr("track \"north\""));
  EXPECT_THAT(error, HasSubstr("track \"south\""));
  EXPECT_THAT(route_file_error(route_file("track.gpx"), choose("west")), HasSubstr("0 lines named \"west\""));
  EXPECT_EQ(read_route(route_file("track.gpx"), choose("south")).vertices.size(), 2U);
  EXPECT_EQ(read_route(route_file("track.gpx"), choose("2")).vertices[0].point.lat_deg, 49);
}

// GDAL's 2.5-D lines say 0 m where a point has no <ele>, which is not the same as 0 m.
TEST(OgrRoute, GpxPointsWithoutElevationHaveNoHeight) {
  const Route route = read_route(route_file("track.gpx"), choose("north"));
  ASSERT_EQ(route.vertices.size(), 4U);
  EXPECT_EQ(route.format, "GPX");
  EXPECT_EQ(route.vertices[0].amsl_m, 300);
  EXPECT_TRUE(std::isnan(route.vertices[1].amsl_m));
  EXPECT_EQ(route.vertices[2].amsl_m, 0);
  EXPECT_EQ(route.legs.size(), 3U) << "segments are joined";
  EXPECT_THAT(route.notes, Contains(HasSubstr("joined by straight legs")));
  EXPECT_THAT(route.notes, Contains(HasSubstr("1 of 4 positions have no height")));
}

TEST(OgrRoute, GpxWaypointsAreALayerOfTheirOwn) {
  RouteOptions options;
  options.layer = "waypoints";
  EXPECT_THAT(route_file_error(route_file("track.gpx"), options), HasSubstr("all positions are at one place"));
  options.layer = "roads";
  EXPECT_THAT(route_file_error(route_file("track.gpx"), options), HasSubstr("layer \"roads\" holds no line"));
}

TEST(OgrRoute, KmlHeightsFollowTheAltitudeMode) {
  const Route clamped = read_route(route_file("lines.kml"), choose("clamped"));
  EXPECT_TRUE(std::isnan(clamped.vertices[0].amsl_m));
  EXPECT_TRUE(std::isnan(clamped.vertices[0].agl_m));
  EXPECT_THAT(clamped.notes, Contains(HasSubstr("--height-reference")));
  const Route absolute = read_route(route_file("lines.kml"), choose("absolute"));
  EXPECT_EQ(absolute.vertices[1].amsl_m, 600);
  const Route relative = read_route(route_file("lines.kml"), choose("relative"));
  ASSERT_EQ(relative.vertices.size(), 2U) << "the doubled point is dropped";
  EXPECT_EQ(relative.vertices[1].agl_m, 130);
  EXPECT_TRUE(std::isnan(relative.vertices[1].amsl_m));
  bool polygon_is_told = false;
  for (const RouteItem& item : relative.items) polygon_is_told |= item.became == "left out: neither a line nor a point";
  EXPECT_TRUE(polygon_is_told);
}

TEST(OgrRoute, KmzIsTheKmlInIt) {
  const Route packed = read_route(route_file("lines.kmz"), choose("absolute"));
  const Route plain = read_route(route_file("lines.kml"), choose("absolute"));
  EXPECT_EQ(packed.format, "KMZ");
  ASSERT_EQ(packed.vertices.size(), plain.vertices.size());
  EXPECT_EQ(packed.vertices[1].amsl_m, plain.vertices[1].amsl_m);
  EXPECT_EQ(packed.vertices[1].point.lat_deg, plain.vertices[1].point.lat_deg);
}

TEST(OgrRoute, GeoJsonAcrossTheAntimeridianIsShort) {
  const Route route = read_route(route_file("antimeridian.geojson"));
  ASSERT_EQ(route.legs.size(), 2U) << "the cut at 180 degrees is no leg";
  EXPECT_NEAR(route_length_m(route), 0.2 * 111319.49 * std::cos(17 * M_PI / 180), 50);
  const Route unwrapped = parse_route("r", line_geojson("[[179.9, -17], [180.1, -17]]"));
  EXPECT_NEAR(route_length_m(unwrapped), route_length_m(route), 1);
  EXPECT_NEAR(unwrapped.vertices[1].point.lon_deg, -179.9, 1e-9);
}

TEST(OgrRoute, GeoJsonHeightsMeanWhatTheUserSays) {
  const std::string text = line_geojson("[[8, 47, 500], [8, 47.1, 500]]");
  EXPECT_TRUE(std::isnan(parse_route("r", text).vertices[0].amsl_m));
  EXPECT_EQ(parse_route("r", text, choose("", HeightReference::kAmsl)).vertices[0].amsl_m, 500);
  EXPECT_EQ(parse_route("r", text, choose("", HeightReference::kAgl)).vertices[0].agl_m, 500);
  RouteOptions home = choose("", HeightReference::kHome);
  EXPECT_THAT(route_error(text, home), HasSubstr("needs home_amsl_m"));
  home.home_amsl_m = 400;
  EXPECT_EQ(parse_route("r", text, home).vertices[0].amsl_m, 900);
}

// OGR gives a line 2.5-D with 0 m where one of its positions has no height; a height of 0 that is written stays.
TEST(OgrRoute, PositionsWithoutAHeightInALineWithHeightsHaveNone) {
  const auto heights = [](const Route& route) {
    std::vector<double> values;
    for (const RouteVertex& vertex : route.vertices) {
      const double height_m = std::isnan(vertex.agl_m) ? vertex.amsl_m : vertex.agl_m;
      values.push_back(std::isnan(height_m) ? -1 : height_m);
    }
    return values;
  };
  const RouteOptions agl = choose("", HeightReference::kAgl);
  const Route json = parse_route("r", line_geojson("[[8, 47], [8, 47.1, 0], [8, 47.2], [8, 47.3, 60]]"), agl);
  EXPECT_EQ(heights(json), (std::vector<double>{-1, 0, -1, 60}));
  EXPECT_THAT(json.notes, Contains(HasSubstr("2 of 4 positions have no height")));
  const Route nested =
      parse_route("r",
                  R"({"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {}, "geometry":
          {"type": "MultiLineString", "coordinates": [[[8, 47, 50], [8, 47.1]], [[8, 47.2, 0], [8, 47.3, 60]]]}}]})",
                  agl);
  EXPECT_EQ(heights(nested), (std::vector<double>{50, -1, 0, 60}));
  const auto kml = [&](const std::string& mode, const std::string& coordinates) {
    return parse_route("r", R"(<kml xmlns="http://www.opengis.net/kml/2.2"><Document><Placemark><LineString>)"
                            "<altitudeMode>" +
                                mode + "</altitudeMode><coordinates>" + coordinates +
                                "</coordinates></LineString></Placemark></Document></kml>");
  };
  EXPECT_EQ(heights(kml("relativeToGround", "8,47,60 8,47.1\n8,47.2,0 8,47.3,")), (std::vector<double>{60, -1, 0, -1}));
  EXPECT_EQ(heights(kml("absolute", " 8,47,360\t8,47.1,0  8,47.2,360 ")), (std::vector<double>{360, 0, 360}));
}

TEST(OgrRoute, PositionsOfATrackWithoutAHeightHaveNone) {
  const Route route = parse_route(
      "r",
      R"(<kml xmlns="http://www.opengis.net/kml/2.2" xmlns:gx="http://www.google.com/kml/ext/2.2"><Placemark><gx:Track>)"
      "<altitudeMode>relativeToGround</altitudeMode><when>2026-01-01T00:00:00Z</when><when>2026-01-01T00:10:00Z</when>"
      "<when>2026-01-01T00:20:00Z</when><gx:coord>8 47 60</gx:coord><gx:coord>8 47.1</gx:coord>"
      "<gx:coord>8 47.2 0</gx:coord></gx:Track></Placemark></kml>");
  ASSERT_EQ(route.vertices.size(), 3U);
  EXPECT_EQ(route.vertices[0].agl_m, 60);
  EXPECT_TRUE(std::isnan(route.vertices[1].agl_m));
  EXPECT_EQ(route.vertices[2].agl_m, 0);
}

TEST(OgrRoute, EllipsoidHeightsComeToSeaLevel) {
  // EGM96 undulations published with the model's test points (NIMA F477: 38.6281550, 269.7791550 -> -31.628;
  // -14.6212170, 305.0211140 -> -2.969), to the 15-minute grid's interpolation error.
  const Route route = parse_route("r", line_geojson("[[-90.220845, 38.628155, 100], [-54.978886, -14.621217, 100]]"),
                                  choose("", HeightReference::kEllipsoid));
  EXPECT_NEAR(route.vertices[0].amsl_m, 131.628, 0.3);
  EXPECT_NEAR(route.vertices[1].amsl_m, 102.969, 0.3);
}

TEST(OgrRoute, GeoPackageInAProjectionComesToWgs84) {
  const testing::TemporaryFolder folder;
  write_file(folder / "line.csv", "id,WKT\n1,\"LINESTRING (500000 5200000, 500000 5300000)\"\n", false);
  const std::string command = "ogr2ogr -q -f GPKG -nln flight -a_srs EPSG:32632 -oo GEOM_POSSIBLE_NAMES=WKT '" +
                              (folder / "line.gpkg").string() + "' '" + (folder / "line.csv").string() +
                              "' 2>/dev/null";
  if (std::system(command.c_str()) != 0) GTEST_SKIP() << "ogr2ogr is not installed: apt-get install gdal-bin";
  const Route route = read_route(folder / "line.gpkg");
  EXPECT_EQ(route.format, "GeoPackage");
  ASSERT_EQ(route.vertices.size(), 2U);
  EXPECT_NEAR(route.vertices[0].point.lon_deg, 9, 1e-9) << "central meridian of UTM zone 32";
  EXPECT_NEAR(route_length_m(route), 100000 / 0.9996, 1);
}

TEST(OgrRoute, BadPositionsAreNamed) {
  EXPECT_THAT(route_error(line_geojson("[[8, 47], [8, 97]]")), HasSubstr("latitude 97 is outside"));
  EXPECT_THAT(route_error(line_geojson("[[8, 47], [800, 47]]")), HasSubstr("longitude 800 is outside"));
  EXPECT_THAT(route_error(line_geojson("[[8, 47], [8, 47]]")), HasSubstr("all positions are at one place"));
  EXPECT_THAT(route_error(line_geojson("[]")), HasSubstr("no position"));
  EXPECT_THAT(route_error(R"({"type": "FeatureCollection", "features": []})"), HasSubstr("r: "));
  EXPECT_THAT(route_error(R"({"type": "Polygon", "coordinates": [[[0,0],[1,0],[1,1],[0,0]]]})"),
              HasSubstr("no position"));
}

TEST(OgrRoute, PolesAreFlownOver) {
  const Route route = parse_route("r", line_geojson("[[0, 89], [180, 89]]"));
  EXPECT_NEAR(route_length_m(route), 2 * 111693.9, 10) << "straight over the pole";
}

/// A GeoPackage of one line, the layer "line".
std::filesystem::path line_geopackage(const std::filesystem::path& folder) {
  VectorLayer layer;
  layer.name = "line";
  layer.shape = VectorShape::kLine;
  layer.crs = Crs::wgs84();
  layer.features.emplace_back().points = {{16.5, 55.5}, {16.6, 55.6}};
  write_geopackage(folder / "line.gpkg", {layer}, "2026-01-01T00:00:00Z", false);
  return folder / "line.gpkg";
}

// A test that does not end is how this fails (raster/gdal_sqlite.h).
TEST(OgrRoute, AGeoPackageThatIsReadInCirclesEnds) {
  const testing::TemporaryFolder folder;
  const std::filesystem::path path = line_geopackage(folder.path());
  EXPECT_EQ(read_route(path).vertices.size(), 2U);
  std::map<std::string, std::string> errors;
  for (const char* table : {"gpkg_contents", "gpkg_geometry_columns", "gpkg_spatial_ref_sys", "line"}) {
    SCOPED_TRACE(table);
    errors[table] = route_error(testing::bytes_in_circles(path, table, 4));
  }
  EXPECT_THAT(errors["gpkg_contents"], HasSubstr("takes SQLite more"));
  EXPECT_THAT(errors["line"], HasSubstr("or more, a route at most 100000"));
}

TEST(OgrRoute, OfAGeoPackageLayersAreReadAndNoOtherViews) {
  const testing::TemporaryFolder folder;
  const std::filesystem::path path = line_geopackage(folder.path());
  Database::create(path, "line")
      .execute(
          "CREATE VIEW st_spatial_ref_sys AS SELECT srs_name FROM gpkg_spatial_ref_sys; CREATE VIEW endless AS WITH "
          "RECURSIVE c(n) AS (SELECT 1 UNION ALL SELECT n + 1 FROM c) SELECT n FROM c WHERE n < 0");
  EXPECT_EQ(read_route(path).vertices.size(), 2U) << "views that the standard gives, and one that is no layer";
  std::string log = read_file(path);
  log[18] = log[19] = 2;  // it says that it has a write-ahead log
  EXPECT_EQ(parse_route("r", log, {}).vertices.size(), 2U);
  Database::create(path, "line").execute("UPDATE gpkg_contents SET table_name = 'Endless'");
  EXPECT_THAT(route_file_error(path), HasSubstr("has the view \"endless\""));
}

}  // namespace
}  // namespace pilotage
