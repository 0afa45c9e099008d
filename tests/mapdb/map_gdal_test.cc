// Foreign eyes on the file: GDAL's GeoPackage validator and ogrinfo, where they are installed.

#include <array>
#include <cstdio>

#include "mapdb/run_command.h"
#include "mapdb/small_map.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

namespace pilotage {
namespace {

using testing::CommandOutcome;

CommandOutcome run(const std::string& command) {
  return testing::run_command(command);
}

testing::SmallMap variant(int index) {
  testing::SmallMap map = testing::make_small_map();
  if (index == 1) {  // a CRS of our own in WKT 2, a route across the antimeridian
    map.header.crs = {
        "Corridor",
        "PROJCRS[\"Corridor\",BASEGEOGCRS[\"WGS 84\",DATUM[\"World Geodetic System 1984\",ELLIPSOID[\"WGS "
        "84\",6378137,298.257223563]]],CONVERSION[\"Corridor\",METHOD[\"Transverse Mercator\"],PARAMETER["
        "\"Longitude of natural origin\",117,ANGLEUNIT[\"degree\",0.0174532925199433]],PARAMETER[\"Scale "
        "factor at natural origin\",0.9996,SCALEUNIT[\"unity\",1]]],CS[Cartesian,2],AXIS[\"easting (E)\","
        "east],AXIS[\"northing (N)\",north],LENGTHUNIT[\"metre\",1]]",
        ""};
    map.route[0].points = {{179.9, 10}, {-179.9, 11}};
  }
  if (index == 2) {  // nothing but the frame
    map.tiles.clear();
    map.values.clear();
    map.descriptors.clear();
    map.chips.clear();
    map.header.chips = false;
    map.route.clear();
    map.legs.clear();
  }
  return map;
}

TEST(MapForGdal, ValidatorAcceptsIt) {
  if (run("/usr/bin/python3 -c 'import osgeo_utils.samples.validate_gpkg'").status != 0) {
    GTEST_SKIP() << "GDAL's Python module is not installed: apt-get install python3-gdal";
  }
  const testing::TemporaryFolder folder;
  for (int index = 0; index < 3; ++index) {
    const auto path = folder / ("map" + std::to_string(index) + ".gpkg");
    testing::write_map(path, variant(index));
    const CommandOutcome outcome =
        run("/usr/bin/python3 -m osgeo_utils.samples.validate_gpkg --extra --warning-as-error " + path.string());
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    EXPECT_EQ(outcome.output, "");
  }
}

TEST(MapForGdal, OgrinfoListsTheLayersWithoutAWarning) {
  if (run("ogrinfo --version").status != 0) GTEST_SKIP() << "ogrinfo is not installed: apt-get install gdal-bin";
  const testing::TemporaryFolder folder;
  for (int index = 0; index < 3; ++index) {
    const auto path = folder / ("map" + std::to_string(index) + ".gpkg");
    testing::write_map(path, variant(index));
    const CommandOutcome list = run("ogrinfo -ro " + path.string());
    EXPECT_EQ(list.status, 0);
    const std::string line_type = "(Line String)\n";
    const std::string route_type = index == 1 ? "(Multi Line String)\n" : line_type;
    EXPECT_EQ(list.output, "INFO: Open of `" + path.string() +
                               "'\n      using driver `GPKG' successful.\n1: tiles (Polygon)\n2: route " + route_type +
                               "3: legs " + line_type + "4: map_info (None)\n");
    const CommandOutcome all = run("ogrinfo -ro -al " + path.string());
    EXPECT_EQ(all.status, 0);
    EXPECT_THAT(all.output, ::testing::Not(::testing::ContainsRegex("Warning|ERROR|WARNING")));
    if (index == 0) {
      EXPECT_THAT(all.output, ::testing::HasSubstr("status (String) = flat"));
    }
  }
}

TEST(MapForGdal, SpatialFilterFindsTilesThroughTheIndex) {
  if (run("ogrinfo --version").status != 0) GTEST_SKIP() << "ogrinfo is not installed: apt-get install gdal-bin";
  const testing::TemporaryFolder folder;
  testing::write_map(folder / "map.gpkg", testing::make_small_map());
  const CommandOutcome outcome =
      run("ogrinfo -ro -q -spat 380001 6440001 380002 6440002 -geom=NO " + (folder / "map.gpkg").string() + " tiles");
  EXPECT_THAT(outcome.output, ::testing::HasSubstr("OGRFeature(tiles):3"));  // level 0, row 1, column 0
  EXPECT_THAT(outcome.output, ::testing::HasSubstr("OGRFeature(tiles):9"));  // level 1, row 1, column 0
  EXPECT_THAT(outcome.output, ::testing::Not(::testing::HasSubstr("OGRFeature(tiles):0")));
}

}  // namespace
}  // namespace pilotage
