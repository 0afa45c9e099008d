#include <cmath>
#include <memory>

#include "testing/temporary_folder.h"
#include <gdal_priv.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <ogrsf_frmts.h>
#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/options_json.h"
#include "pilotage/base/output_file.h"
#include "pilotage/raster/gdal_degrees.h"
#include "pilotage/raster/gdal_io.h"
#include "pilotage/raster/gdal_zip.h"

namespace pilotage {
namespace {

using testing::TemporaryFolder;

constexpr const char* kDate = "2026-01-02T03:04:05.000Z";

VectorLayer lines(std::vector<std::vector<Eigen::Vector2d>> shapes) {
  VectorLayer layer;
  layer.name = "lines";
  layer.title = "Lines";
  layer.shape = VectorShape::kLine;
  layer.crs = Crs::wgs84();
  layer.columns = {{"number", VectorType::kInteger, ""}, {"name", VectorType::kText, "Name"}};
  for (auto& points : shapes) {
    VectorFeature feature;
    feature.points = std::move(points);
    feature.values = {static_cast<std::int64_t>(layer.features.size()), std::string("<a> & \"b\" é")};
    feature.title = "Line";
    feature.style = {"#112233ff", 2, ""};
    layer.features.push_back(std::move(feature));
  }
  return layer;
}

VectorLayer square_in_utm() {
  VectorLayer layer;
  layer.name = "squares";
  layer.shape = VectorShape::kPolygon;
  layer.crs = Crs::from_user_input("EPSG:32633");
  VectorFeature feature;
  feature.points = {{500000, 5000100}, {500100, 5000100}, {500100, 5000000}, {500000, 5000000}};  // clockwise
  layer.features.push_back(feature);
  return layer;
}

nlohmann::ordered_json written_geojson(const TemporaryFolder& folder, const VectorLayer& layer) {
  write_geojson(folder / "a.geojson", layer, true);
  return parse_json("a.geojson", read_file(folder / "a.geojson"));
}

TEST(WriteGeojson, FollowsTheStandard) {
  const TemporaryFolder folder;
  const auto json = written_geojson(folder, square_in_utm());
  EXPECT_FALSE(json.contains("crs"));
  const auto& ring = json["features"][0]["geometry"]["coordinates"][0];
  ASSERT_EQ(ring.size(), 5u);
  EXPECT_EQ(ring[0], ring[4]);
  double area = 0;  // counter-clockwise: positive
  for (std::size_t i = 0; i < 4; ++i) {
    area += ring[i][0].get<double>() * ring[i + 1][1].get<double>() -
            ring[i + 1][0].get<double>() * ring[i][1].get<double>();
  }
  EXPECT_GT(area, 0);
  const auto center = CrsTransform(Crs::from_user_input("EPSG:32633")).geodetic_from_map({500000, 5000100});
  EXPECT_NEAR(ring[0][0].get<double>(), center->lon_deg, 1e-7);
  EXPECT_NEAR(ring[0][1].get<double>(), center->lat_deg, 1e-7);
}

TEST(WriteGeojson, CutsLinesAtTheAntimeridian) {
  const TemporaryFolder folder;
  const auto json = written_geojson(folder, lines({{{179.9, 1}, {-179.9, 2}}, {{1, 1}, {2, 2}}}));
  const auto& cut = json["features"][0]["geometry"];
  EXPECT_EQ(cut["type"], "MultiLineString");
  ASSERT_EQ(cut["coordinates"].size(), 2u);
  EXPECT_EQ(cut["coordinates"][0][1][0], 180.0);
  EXPECT_EQ(cut["coordinates"][1][0][0], -180.0);
  EXPECT_NEAR(cut["coordinates"][0][1][1].get<double>(), 1.5, 1e-6);
  EXPECT_EQ(json["features"][1]["properties"]["name"], "<a> & \"b\" é");
}

TEST(WriteGeojson, RefusesWhatDoesNotFit) {
  const TemporaryFolder folder;
  EXPECT_THROW(write_geojson(folder / "a.geojson", lines({{{1, 1}}}), false), UsageError);
  EXPECT_THROW(write_geojson(folder / "a.geojson", lines({{{1, NAN}, {2, 2}}}), false), UsageError);
  VectorLayer layer = lines({{{1, 1}, {2, 2}}});
  layer.features[0].values.pop_back();
  EXPECT_THROW(write_geojson(folder / "a.geojson", layer, false), UsageError);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.geojson"));
  write_file(folder / "a.geojson", "mine", false);
  EXPECT_THROW(write_geojson(folder / "a.geojson", lines({}), false), DataError);
  EXPECT_THROW(write_geojson(folder / "none" / "a.geojson", lines({}), false), DataError);
  EXPECT_EQ(read_file(folder / "a.geojson"), "mine");
}

TEST(WriteGeoPackage, HoldsLayersInTheirOwnCrsAndTheirStyles) {
  const TemporaryFolder folder;
  VectorLayer styled = lines({{{1, 1}, {2, 2}}});
  styled.qml = "<qgis/>";
  write_geopackage(folder / "a.gpkg", {square_in_utm(), styled}, kDate, false);
  write_geopackage(folder / "b.gpkg", {square_in_utm(), styled}, kDate, false);
  EXPECT_TRUE(read_file(folder / "a.gpkg") == read_file(folder / "b.gpkg"));
  EXPECT_THROW(write_geopackage(folder / "a.gpkg", {styled}, kDate, false), DataError);
  const std::unique_ptr<GDALDataset> dataset(GDALDataset::Open((folder / "a.gpkg").c_str(), GDAL_OF_VECTOR));
  ASSERT_NE(dataset, nullptr);
  EXPECT_STREQ(dataset->GetLayerByName("squares")->GetSpatialRef()->GetAuthorityCode(nullptr), "32633");
  OGRLayer* styles = dataset->GetLayerByName("layer_styles");
  ASSERT_NE(styles, nullptr);
  ASSERT_EQ(styles->GetFeatureCount(), 1);
  const std::unique_ptr<OGRFeature> style(styles->GetNextFeature());
  EXPECT_STREQ(style->GetFieldAsString("f_table_name"), "lines");
  EXPECT_STREQ(style->GetFieldAsString("f_geometry_column"), "geom");
  EXPECT_STREQ(style->GetFieldAsString("styleQML"), "<qgis/>");
  EXPECT_EQ(style->GetFieldAsInteger("useAsDefault"), 1);
}

TEST(WriteGeoPackage, WithoutStylesThereIsNoTableOfThem) {
  const TemporaryFolder folder;
  write_geopackage(folder / "a.gpkg", {square_in_utm()}, kDate, false);
  const std::unique_ptr<GDALDataset> dataset(GDALDataset::Open((folder / "a.gpkg").c_str(), GDAL_OF_VECTOR));
  EXPECT_EQ(dataset->GetLayerCount(), 1);
}

TEST(KmlDocument, HoldsFoldersStylesAndEscapedText) {
  const std::string kml = kml_document("A <title> & more", {lines({{{1, 1}, {2, 2}}})});
  EXPECT_THAT(kml, ::testing::HasSubstr("<name>A &lt;title&gt; &amp; more</name>"));
  EXPECT_THAT(kml, ::testing::HasSubstr("<color>ff332211</color>"));
  EXPECT_THAT(kml,
              ::testing::HasSubstr("<displayName>Name</displayName><value>&lt;a&gt; &amp; &quot;b&quot; é</value>"));
  EXPECT_THAT(kml, ::testing::HasSubstr("<name>Line</name>"));
  EXPECT_THAT(kml, ::testing::HasSubstr("<tessellate>1</tessellate>"));
  EXPECT_EQ(kml, kml_document("A <title> & more", {lines({{{1, 1}, {2, 2}}})}));
}

TEST(JoinPolygons, JoinsWhatTouchesAndRefusesWhatDoesNot) {
  const std::vector<Eigen::Vector2d> left = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  const std::vector<Eigen::Vector2d> right = {{1, 0}, {2, 0}, {2, 1}, {1, 1}};
  const std::vector<Eigen::Vector2d> far = {{5, 0}, {6, 0}, {6, 1}, {5, 1}};
  const VectorFeature joined = join_polygons({left, right});
  EXPECT_GE(joined.points.size(), 4u);
  EXPECT_TRUE(joined.holes.empty());
  EXPECT_THROW(join_polygons({left, far}), UsageError);
  EXPECT_THROW(join_polygons({}), UsageError);
}

TEST(PictureInDegrees, EveryPixelLiesOverItsGround) {
  cv::Mat rgba(40, 60, CV_8UC4, cv::Scalar::all(0));
  for (int row = 0; row < rgba.rows; ++row) {
    for (int col = 0; col < rgba.cols; ++col) {
      rgba.at<cv::Vec4b>(row, col) = cv::Vec4b(static_cast<std::uint8_t>(col), static_cast<std::uint8_t>(row), 7, 255);
    }
  }
  for (const double lon_deg : {9.0, 180.0}) {  // in the middle of a zone's edge, and across the antimeridian
    const Crs crs =
        Crs::from_user_input("+proj=tmerc +lat_0=50 +datum=WGS84 +units=m +lon_0=" + std::to_string(lon_deg));
    const GeoTransform place = GeoTransform::north_up(-3000, 2000, 100);
    const DegreePicture picture = picture_in_degrees(rgba, crs, place, 8, 1000);
    EXPECT_GT(picture.east_deg, picture.west_deg);
    EXPECT_LT(picture.east_deg - picture.west_deg, 0.2);
    const CrsTransform transform(crs);
    int seen = 0;
    for (int y = 0; y < picture.rgba.rows; y += 7) {
      for (int x = 0; x < picture.rgba.cols; x += 7) {
        const auto pixel = picture.rgba.at<cv::Vec4b>(y, x);
        if (pixel[3] == 0) continue;
        GeodeticPoint point;
        point.lon_deg = picture.west_deg + (picture.east_deg - picture.west_deg) * (x + 0.5) / picture.rgba.cols;
        point.lat_deg = picture.north_deg - (picture.north_deg - picture.south_deg) * (y + 0.5) / picture.rgba.rows;
        if (point.lon_deg >= 180) point.lon_deg -= 360;
        const auto map = transform.map_from_geodetic(point);
        ASSERT_TRUE(map);
        EXPECT_NEAR(pixel[0] + 0.5, (map->x() + 3000) / 100, 0.65);  // half a cell, and an eighth
        EXPECT_NEAR(pixel[1] + 0.5, (2000 - map->y()) / 100, 0.65);
        ++seen;
      }
    }
    EXPECT_GT(seen, 1000);
  }
  EXPECT_THROW(picture_in_degrees(cv::Mat(2, 2, CV_8UC3), Crs::wgs84(), {}, 1, 10), UsageError);
}

TEST(WriteZip, IsTheSameEachTimeAndRefusesExistingFiles) {
  const TemporaryFolder folder;
  const std::vector<std::pair<std::string, std::string>> files = {{"doc.kml", std::string(5000, 'x')},
                                                                  {"a/b.png", "yz"}};
  write_zip(folder / "a.zip", files, false);
  write_zip(folder / "b.zip", files, false);
  EXPECT_EQ(read_file(folder / "a.zip"), read_file(folder / "b.zip"));
  EXPECT_LT(read_file(folder / "a.zip").size(), 1000u);
  EXPECT_THROW(write_zip(folder / "a.zip", files, false), DataError);
  VSILFILE* file = VSIFOpenL(("/vsizip/" + (folder / "a.zip").string() + "/a/b.png").c_str(), "rb");
  ASSERT_NE(file, nullptr);
  char bytes[8] = {};
  EXPECT_EQ(VSIFReadL(bytes, 1, 8, file), 2u);
  EXPECT_STREQ(bytes, "yz");
  VSIFCloseL(file);
}

}  // namespace
}  // namespace pilotage
