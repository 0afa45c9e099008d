#include "pilotage/gis/report_outputs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <set>

#include "gis/gis_scene.h"
#include "mapdb/run_command.h"
#include "testing/error_of.h"
#include "testing/temporary_folder.h"
#include <gdal_priv.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <ogrsf_frmts.h>

#include "pilotage/base/error.h"
#include "pilotage/base/options_json.h"
#include "pilotage/base/output_file.h"
#include "pilotage/gis/degree_overlay.h"
#include "pilotage/gis/score_files.h"
#include "pilotage/ground/score_raster.h"
#include "pilotage/verdict/tile_class.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing::run_command;
using testing::TemporaryFolder;

const std::vector<ReportOutput> kEverything = {ReportOutput::kAll};

std::vector<std::string> write_all(const TemporaryFolder& folder, const ReportInput& input,
                                   const std::vector<ReportOutput>& outputs = kEverything) {
  const TemporaryFolder sources;
  return write_report_outputs(folder.path(), "report", testing::with_imagery(input, sources.path()), make_report(input),
                              outputs, true);
}

std::set<std::string> names_in(const TemporaryFolder& folder) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    names.insert(entry.path().filename().string());
  }
  return names;
}

std::unique_ptr<GDALDataset> open(const std::filesystem::path& path) {
  GDALAllRegister();
  std::unique_ptr<GDALDataset> dataset(GDALDataset::Open(path.c_str(), GDAL_OF_READONLY));
  EXPECT_NE(dataset, nullptr) << path;
  return dataset;
}

bool has_python_gdal() {
  return run_command("/usr/bin/python3 -c 'import osgeo_utils.samples.validate_gpkg'").status == 0;
}

TEST(ReportOutputs, WritesWhatItSaysAndNothingElse) {
  const TemporaryFolder folder;
  ReportInput input = testing::gis_scene();
  input.mission.flight.denied.stretches = {{10, 60}};
  for (RouteVertex& vertex : input.mission.flight.route.vertices) {
    vertex.amsl_m = 300;
    vertex.speed_mps = 15;
  }
  input.mission.flight.autopilot = Autopilot::kArduplane;
  const std::vector<std::string> names = write_all(folder, input);
  const std::set<std::string> written(names.begin(), names.end());
  EXPECT_EQ(names_in(folder), written);
  const std::vector<std::string> told = report_output_names("report", kEverything, input.mission.ground.levels, true);
  std::set<std::string> said(told.begin(), told.end());
  EXPECT_EQ(said.erase("report_autopilot.params"), 1u) << "of the other family";
  EXPECT_EQ(said, written);
  EXPECT_EQ(written.size(), 30u);
  for (const std::string& name : names) EXPECT_TRUE(is_report_output("report", name)) << name;
  EXPECT_FALSE(is_report_output("report", "report.txt"));
  EXPECT_FALSE(is_report_output("report", "report_levels.tif"));
}

// Asked for by name, its absence would be a surprise; as a part of all outputs it is not.
TEST(ReportOutputs, ARouteThatADjiMissionCannotHoldIsRefusedByName) {
  const TemporaryFolder folder;
  const ReportInput input = testing::gis_scene();
  EXPECT_EQ(testing::error_of<DataError>([&] { write_all(folder, input, {ReportOutput::kDji}); }),
            "valley.plan: waypoint 1 has no height, which a DJI mission needs");
  const std::vector<std::string> names = write_all(folder, input);
  EXPECT_EQ(std::count(names.begin(), names.end(), "report_dji.kmz"), 0);
}

TEST(ReportOutputs, NoLayerOfDeniedStretchesWhereNothingSaysSo) {
  const TemporaryFolder folder;
  const std::vector<std::string> names = write_all(folder, testing::gis_scene());
  EXPECT_EQ(names.size(), 27u);
  EXPECT_EQ(std::count(names.begin(), names.end(), "report_denied.geojson"), 0);
  EXPECT_TRUE(is_report_output("report", "report_denied.geojson")) << "one of an earlier run is taken away";
}

// The numbers in the file are those that the planning program shows, so that a leg that must move is found there.
TEST(ReportOutputs, WaypointsHaveTheNumbersOfThePlan) {
  const TemporaryFolder folder;
  ReportInput input = testing::gis_scene();
  std::vector<RouteVertex>& vertices = input.mission.flight.route.vertices;
  vertices.clear();
  const auto add = [&](double lon_deg, int item, const std::string& kind) {
    RouteVertex vertex;
    vertex.point = {lon_deg, 51.96};
    vertex.source_item = item;
    vertex.kind = kind;
    vertices.push_back(vertex);
  };
  add(7.600, -1, "home");
  add(7.601, 2, "waypoint");
  add(7.602, 5, "spline waypoint");
  add(7.603, 5, "spline waypoint");
  add(7.604, 7, "survey");
  add(7.605, 7, "survey");
  input.mission.flight.route.items = {{2, 16, "waypoint", "1 vertex"}};  // a mission's items have commands
  write_all(folder, input, {ReportOutput::kRoute});
  const auto dataset = open(folder / "report_route.kml");
  OGRLayer* waypoints = dataset->GetLayerByName("Waypoints");
  ASSERT_NE(waypoints, nullptr);
  std::vector<std::pair<std::string, double>> found;
  while (const std::unique_ptr<OGRFeature> feature{waypoints->GetNextFeature()}) {
    found.emplace_back(feature->GetFieldAsString("Name"), feature->GetGeometryRef()->toPoint()->getX());
  }
  ASSERT_EQ(found.size(), 4U);
  EXPECT_EQ(found[0], std::pair(std::string("home"), 7.600));
  EXPECT_EQ(found[1], std::pair(std::string("2"), 7.601));
  EXPECT_EQ(found[2], std::pair(std::string("5"), 7.603)) << "a curve ends at its waypoint";
  EXPECT_EQ(found[3], std::pair(std::string("7"), 7.604)) << "a survey begins at its first point";
}

TEST(ReportOutputs, TheHeatMapAsMbtilesShowsTheCellsInTheirColours) {
  const TemporaryFolder folder;
  const ReportInput input = testing::gis_scene();
  const Report report = make_report(input);
  write_all(folder, input, {ReportOutput::kMbtiles, ReportOutput::kCog});
  const auto dataset = open(folder / "report.mbtiles");
  EXPECT_EQ(std::string(dataset->GetDriverName()), "MBTiles");
  EXPECT_EQ(dataset->GetRasterCount(), 4);
  EXPECT_GE(dataset->GetRasterBand(1)->GetOverviewCount(), 1);
  std::array<double, 6> place{};
  ASSERT_EQ(dataset->GetGeoTransform(place.data()), CE_None);
  const ScoreTable table(input.mission.ground, input.scores);
  const ScoreRaster raster = score_raster(table, 0);
  const auto shown = shown_measure(raster, input.scores);
  ASSERT_TRUE(shown.has_value());
  const cv::Mat& values = raster.bands[static_cast<std::size_t>(shown->band - 1)].values;
  const cv::Mat picture = heat_picture(values, shown->scale);
  const CrsTransform from_grid(input.mission.ground.crs);
  const CrsTransform to_web(Crs::from_user_input("EPSG:3857"));
  int colored = 0;
  for (int row = 0; row < values.rows; ++row) {
    for (int col = 0; col < values.cols; ++col) {
      const auto point = from_grid.geodetic_from_map(raster.map_from_pixel.map_from_pixel({col + 0.5, row + 0.5}));
      const auto web = to_web.map_from_geodetic(*point);
      const int x = static_cast<int>(std::floor((web->x() - place[0]) / place[1]));
      const int y = static_cast<int>(std::floor((web->y() - place[3]) / place[5]));
      std::array<std::uint8_t, 4> pixel{};
      ASSERT_EQ(dataset->RasterIO(GF_Read, x, y, 1, 1, pixel.data(), 1, 1, GDT_Byte, 4, nullptr, 0, 0, 0), CE_None);
      const auto wanted = picture.at<cv::Vec4b>(row, col);
      EXPECT_EQ(pixel[3], wanted[3]) << col << ", " << row;
      if (wanted[3] == 0) continue;
      for (int band = 0; band < 3; ++band) EXPECT_EQ(pixel[static_cast<std::size_t>(band)], wanted[band]);
      ++colored;
    }
  }
  EXPECT_GT(colored, 3);
}

// EPSG:3857 ends there, and a picture of both sides would go around the world.
TEST(ReportOutputs, NoMbtilesOverTheAntimeridian) {
  const TemporaryFolder folder;
  EXPECT_TRUE(write_all(folder, testing::gis_scene({179.988, -16.5}), {ReportOutput::kMbtiles}).empty());
}

TEST(ReportOutputs, OnlyWhatIsAskedForIsWritten) {
  const TemporaryFolder folder;
  write_all(folder, testing::gis_scene(), {ReportOutput::kKml, ReportOutput::kJson});
  EXPECT_EQ(names_in(folder), (std::set<std::string>{"report.json", "report_areas.kml", "report_legs.kml"}));
}

TEST(ReportOutputs, TheSameReportGivesTheSameBytes) {
  const TemporaryFolder first;
  const TemporaryFolder second;
  write_all(first, testing::gis_scene());
  for (const std::string& name : write_all(second, testing::gis_scene())) {
    EXPECT_TRUE(read_file(first / name) == read_file(second / name)) << name;
  }
}

TEST(ReportOutputs, DatesOfTheGeoPackageComeFromTheEnvironment) {
  const TemporaryFolder folder;
  ::setenv("SOURCE_DATE_EPOCH", "1700000000", 1);
  write_all(folder, testing::gis_scene(), {ReportOutput::kGpkg});
  ::unsetenv("SOURCE_DATE_EPOCH");
  const auto dataset = open(folder / "report.gpkg");
  OGRLayer* dates = dataset->ExecuteSQL(
      "SELECT last_change AS d FROM gpkg_contents UNION SELECT update_time AS d FROM layer_styles", nullptr, nullptr);
  ASSERT_NE(dates, nullptr);
  EXPECT_EQ(dates->GetFeatureCount(), 1);
  const std::unique_ptr<OGRFeature> row(dates->GetNextFeature());
  EXPECT_THAT(row->GetFieldAsString(0), HasSubstr("2023"));
  dataset->ReleaseResultSet(dates);
}

TEST(ReportOutputs, InterruptedItStops) {
  const TemporaryFolder folder;
  const ReportInput input = testing::gis_scene();
  const auto stop = [](std::string_view, std::int64_t done, std::int64_t) { return done < 2; };
  EXPECT_THROW(
      write_report_outputs(folder.path(), "report", input, make_report(input), kEverything, true, 0, Progress(stop)),
      Interrupted);
}

TEST(ReportOutputs, VectorFilesReadBackTheNumbersOfTheReport) {
  const TemporaryFolder folder;
  const ReportInput input = testing::gis_scene();
  write_all(folder, input);
  const auto json = parse_json("report.json", read_file(folder / "report.json"));
  const auto& columns = json["tiles"]["columns"];
  const auto index_of = [&](const char* name) {
    return static_cast<std::size_t>(std::find(columns.begin(), columns.end(), name) - columns.begin());
  };
  for (const char* file : {"report.gpkg", "report_tiles.geojson"}) {
    const auto dataset = open(folder / file);
    OGRLayer* tiles = dataset->GetLayerByName("tiles");
    ASSERT_NE(tiles, nullptr) << file;
    ASSERT_EQ(tiles->GetFeatureCount(), static_cast<GIntBig>(json["tiles"]["rows"].size())) << file;
    for (const auto& row : json["tiles"]["rows"]) {
      const std::unique_ptr<OGRFeature> feature(tiles->GetNextFeature());
      for (std::size_t c = 0; c < columns.size(); ++c) {
        const int field = feature->GetFieldIndex(columns[c].get<std::string>().c_str());
        ASSERT_GE(field, 0) << columns[c];
        if (row[c].is_null()) {
          EXPECT_FALSE(feature->IsFieldSetAndNotNull(field)) << file << columns[c];
        } else if (row[c].is_string()) {
          EXPECT_EQ(feature->GetFieldAsString(field), row[c].get<std::string>());
        } else {
          EXPECT_EQ(feature->GetFieldAsDouble(field), row[c].is_boolean() ? row[c].get<bool>() : row[c].get<double>());
        }
      }
      OGRPoint middle;
      feature->GetGeometryRef()->Centroid(&middle);
      if (std::string(file) == "report.gpkg") continue;  // in the mission grid
      EXPECT_NEAR(middle.getX(), row[index_of("center_lon_deg")].get<double>(), 2e-5);
      EXPECT_NEAR(middle.getY(), row[index_of("center_lat_deg")].get<double>(), 2e-5);
    }
  }
}

TEST(ReportOutputs, RastersHoldScoresAndClasses) {
  const TemporaryFolder folder;
  const ReportInput input = testing::gis_scene({7.6, 51.96}, false);
  write_all(folder, input, {ReportOutput::kCog});
  const auto scores = open(folder / "report_scores.tif");
  const auto classes = open(folder / "report_classes.tif");
  GDALRasterBand* p = nullptr;
  for (int i = 1; i <= scores->GetRasterCount(); ++i) {
    if (std::string(scores->GetRasterBand(i)->GetDescription()) == "p_correct_fix") p = scores->GetRasterBand(i);
  }
  ASSERT_NE(p, nullptr);
  EXPECT_NE(p->GetMetadataItem("STATISTICS_MEAN"), nullptr);
  GDALRasterBand* band = classes->GetRasterBand(1);
  std::array<double, 6> place{};
  ASSERT_EQ(classes->GetGeoTransform(place.data()), CE_None);  // GDAL reads the .aux.xml when it is asked for a place
  ASSERT_NE(band->GetCategoryNames(), nullptr);
  EXPECT_STREQ(band->GetCategoryNames()[1], "marginal");
  ASSERT_EQ(classes->GetRasterXSize(), 7);
  ASSERT_EQ(classes->GetRasterYSize(), 14);
  for (std::size_t i = 0; i < input.scores.size(); ++i) {
    const TileScores& score = input.scores[i];
    double value = 0;
    std::uint8_t number = 0;
    const int col = static_cast<int>(input.mission.ground.tiles[i].column);
    const int row = static_cast<int>(input.mission.ground.tiles[i].row);
    ASSERT_EQ(p->RasterIO(GF_Read, col, row, 1, 1, &value, 1, 1, GDT_Float64, 0, 0, nullptr), CE_None);
    ASSERT_EQ(band->RasterIO(GF_Read, col, row, 1, 1, &number, 1, 1, GDT_Byte, 0, 0, nullptr), CE_None);
    EXPECT_TRUE(value == score.p_correct_fix || (std::isnan(value) && std::isnan(score.p_correct_fix)));
    EXPECT_EQ(number, static_cast<std::uint8_t>(tile_class(score).value()));
  }
}

TEST(ReportOutputs, ForeignValidatorsAcceptThem) {
  if (!has_python_gdal()) GTEST_SKIP() << "GDAL's Python module is not installed: apt-get install python3-gdal";
  const TemporaryFolder folder;
  write_all(folder, testing::gis_scene());
  const std::string modules = "/usr/bin/python3 -m osgeo_utils.samples.";
  const auto gpkg =
      run_command(modules + "validate_gpkg --extra --warning-as-error " + (folder / "report.gpkg").string());
  EXPECT_EQ(gpkg.status, 0) << gpkg.output;
  EXPECT_EQ(gpkg.output, "");
  for (const char* name :
       {"report_scores.tif", "report_scores_level1.tif", "report_classes.tif", "report_classes_level1.tif"}) {
    const auto cog = run_command(modules + "validate_cloud_optimized_geotiff " + (folder / name).string());
    EXPECT_EQ(cog.status, 0) << cog.output;
    EXPECT_THAT(cog.output, HasSubstr("is a valid cloud optimized GeoTIFF"));
  }
}

TEST(ReportOutputs, OgrinfoListsLayersStylesAndNoWarning) {
  if (run_command("ogrinfo --version").status != 0)
    GTEST_SKIP() << "ogrinfo is not installed: apt-get install gdal-bin";
  const TemporaryFolder folder;
  write_all(folder, testing::gis_scene());
  const auto list = run_command("ogrinfo -ro -q " + (folder / "report.gpkg").string());
  EXPECT_EQ(list.output,
            "1: decision (Polygon)\n2: tiles (Polygon)\n3: areas (Polygon)\n4: legs (Line String)\n"
            "5: gaps (Line String)\n6: route (Line String)\n7: report (None)\n8: layer_styles (None)\n");
  const auto styles = run_command("ogrinfo -ro -q " + (folder / "report.gpkg").string() + " layer_styles");
  EXPECT_THAT(styles.output, HasSubstr("f_table_name (String) = legs"));
  EXPECT_THAT(styles.output, HasSubstr("useAsDefault (Integer(Boolean)) = 1"));
  for (const char* name : {"report.gpkg", "report.kmz", "report_legs.kml", "report_areas.kml", "report_gaps.geojson"}) {
    const auto all = run_command("ogrinfo -ro -al " + (folder / name).string());
    EXPECT_EQ(all.status, 0) << name;
    EXPECT_THAT(all.output, Not(::testing::ContainsRegex("Warning|ERROR|WARNING"))) << name;
  }
}

TEST(ReportOutputs, TheKmzHoldsEveryPictureItNames) {
  const TemporaryFolder folder;
  write_all(folder, testing::gis_scene(), {ReportOutput::kKmz});
  const auto dataset = open(folder / "report.kmz");
  ASSERT_NE(dataset, nullptr);
  EXPECT_NE(dataset->GetLayerByName("Tiles"), nullptr);
  // Before it GDAL counts the document itself, which holds the overlays.
  EXPECT_STREQ(dataset->GetLayer(1)->GetName(), "Decision: go, marginal, no-go");
  const std::string listing =
      run_command("/usr/bin/python3 -c \"import zipfile, re; z = zipfile.ZipFile('" + (folder / "report.kmz").string() +
                  "'); d = z.read('doc.kml').decode(); h = re.findall('<href>(.*?)</href>', d); "
                  "print(z.testzip(), sorted(h) == sorted(z.namelist()[1:]), len(h), 'http' in str(h), "
                  "d.count('<GroundOverlay><name>P(correct fix)</name><visibility>0'))\"")
          .output;
  EXPECT_EQ(listing, "None True 3 False 2\n");  // a heat map for each level, to be switched on, and one legend
}

TEST(ReportOutputs, AcrossTheAntimeridianShapesAreCut) {
  const TemporaryFolder folder;
  const GeodeticPoint origin{179.99, 12};  // the corridor's middle lies about 1.5 km to the east, the line 1.1 km
  write_all(folder, testing::gis_scene(origin));
  for (const char* name : {"report_tiles.geojson", "report_areas.geojson"}) {
    const auto dataset = open(folder / name);
    OGREnvelope all;
    ASSERT_EQ(dataset->GetLayer(0)->GetExtent(&all), OGRERR_NONE);
    EXPECT_EQ(all.MinX, -180) << name;
    EXPECT_EQ(all.MaxX, 180) << name;
    for (auto& feature : *dataset->GetLayer(0)) {
      OGRGeometry* shape = feature->GetGeometryRef();
      const auto parts = wkbFlatten(shape->getGeometryType()) == wkbMultiPolygon ? shape->toMultiPolygon() : nullptr;
      for (int i = 0; i < (parts == nullptr ? 1 : parts->getNumGeometries()); ++i) {
        OGREnvelope part;
        (parts == nullptr ? shape : parts->getGeometryRef(i))->getEnvelope(&part);
        EXPECT_LT(part.MaxX - part.MinX, 1) << name;
      }
    }
  }
  const std::string kml =
      run_command("/usr/bin/python3 -c \"import zipfile, re; d = zipfile.ZipFile('" + (folder / "report.kmz").string() +
                  "').read('doc.kml').decode(); e = re.search('<east>(.*?)</east>', d)[1]; "
                  "w = re.search('<west>(.*?)</west>', d)[1]; "
                  "print(0 < float(e) - float(w) < 0.1)\"")
          .output;
  EXPECT_EQ(kml, "True\n");
}

TEST(ReportOutputs, APlanWithoutMeasuresAndRouteStillWorks) {
  const TemporaryFolder folder;
  ReportInput input = testing::gis_scene();
  input.scores.assign(input.mission.ground.tiles.size(), {});
  input.selection = {};
  input.mission.flight.route = {};
  input.mission.flight.samples.clear();
  const std::vector<std::string> names = write_all(folder, input);
  EXPECT_EQ(names_in(folder), std::set<std::string>(names.begin(), names.end()));
  EXPECT_EQ(open(folder / "report_tiles.geojson")->GetLayer(0)->GetFeatureCount(),
            static_cast<GIntBig>(input.mission.ground.tiles.size()));
}

}  // namespace
}  // namespace pilotage
