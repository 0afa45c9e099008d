#include <filesystem>
#include <fstream>

#include "raster/raster_maker.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/raster/gdal_access.h"
#include "pilotage/raster/gdal_imagery.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// What inspecting a raster says against it, "" when nothing.
std::string refusal_of(const std::string& dataset) {
  try {
    inspect_imagery(dataset);
  } catch (const DataError& error) {
    return error.what();
  }
  return "";
}

class RasterAccessTest : public ::testing::Test {
 protected:
  RasterAccessTest() {
    std::filesystem::create_directory(folder_ / "mosaic");
    inside_ = testing::make_raster(folder_ / "mosaic/a.tif", {});
    outside_ = testing::make_raster(folder_ / "b.tif", {});
  }
  ~RasterAccessTest() override { set_raster_access({}); }

  /// A VRT of one source in the folder mosaic.
  std::string vrt(const std::string& name, const std::string& source, bool beside, const std::string& band = "") const {
    const std::string path = (folder_ / "mosaic" / name).string();
    write_file(
        path,
        "<VRTDataset rasterXSize=\"60\" rasterYSize=\"40\"><SRS>EPSG:32633</SRS>"
        "<GeoTransform>500000, 0.5, 0, 5000000, 0, -0.5</GeoTransform><VRTRasterBand dataType=\"Byte\" band=\"1\"" +
            band + "><SimpleSource><SourceFilename relativeToVRT=\"" + (beside ? "1" : "0") + "\">" + source +
            "</SourceFilename><SourceBand>1</SourceBand></SimpleSource></VRTRasterBand></VRTDataset>",
        true);
    return path;
  }

  testing::TemporaryFolder folder_;
  std::string inside_;
  std::string outside_;
};

TEST_F(RasterAccessTest, AVrtReadsWhatLiesInItsFolder) {
  EXPECT_EQ(refusal_of(vrt("a.vrt", "a.tif", true)), "");
  EXPECT_EQ(refusal_of(vrt("full.vrt", inside_, false)), "");
  EXPECT_EQ(refusal_of(vrt("twice.vrt", "a.vrt", true)), "");
}

TEST_F(RasterAccessTest, AVrtThatLeadsElsewhereIsRefusedUnlessAskedFor) {
  const std::string above = vrt("above.tif", "../b.tif", true);
  EXPECT_THAT(refusal_of(above), HasSubstr("above.tif: its source \"../b.tif\" is no file in the folder"));
  EXPECT_THAT(refusal_of(above), HasSubstr("--allow-any-vrt"));
  EXPECT_THAT(refusal_of(vrt("full.vrt", outside_, false)), HasSubstr("b.tif\" is no file in the folder"));
  EXPECT_THAT(refusal_of(vrt("nested.vrt", "above.tif", true)), HasSubstr("nested.vrt: its source \"../b.tif\""));
  EXPECT_THAT(refusal_of(vrt("part.vrt", "GTIFF_DIR:1:" + outside_, false)), HasSubstr("--allow-any-vrt"));
  EXPECT_THAT(refusal_of(vrt("bytes.vrt", "/vsisubfile/0_100," + outside_, false)), HasSubstr("--allow-any-vrt"));
  std::filesystem::create_symlink(outside_, folder_ / "mosaic/link.tif");
  EXPECT_THAT(refusal_of(vrt("link.vrt", "link.tif", true)), HasSubstr("\"link.tif\" is no file in the folder"));
  set_raster_access({.any_vrt = true, .drivers = {}});
  EXPECT_EQ(refusal_of(above), "");
}

TEST_F(RasterAccessTest, ARawBandIsRefusedUnlessAskedFor) {
  const std::string raw = vrt("raw.tif", "a.tif", true, " subClass=\"VRTRawRasterBand\"");
  EXPECT_THAT(refusal_of(raw), HasSubstr("raw.tif: has a raw band (VRTRawRasterBand)"));
  EXPECT_THAT(refusal_of("<VRTDataset><VRTRasterBand subclass=\"vrtrawrasterband\"/></VRTDataset>"),
              HasSubstr("has a raw band"));
}

TEST_F(RasterAccessTest, NamesThatLeadOffThisMachineAreRefused) {
  for (const char* name : {"/vsicurl/http://192.0.2.1/a.tif", "/vsicurl?url=http://192.0.2.1/a.tif", "/vsis3/b/a.tif",
                           "/vsizip//vsicurl/http://192.0.2.1/a.zip/a.tif", "http://192.0.2.1/a.tif",
                           "WMS:http://192.0.2.1/?SERVICE=WMS", "vrt:///vsicurl/http://192.0.2.1/a.tif"}) {
    EXPECT_THAT(refusal_of(name), HasSubstr("--allow-network")) << name;
  }
}

TEST_F(RasterAccessTest, OtherDriversAreNamedAndCanBeAskedFor) {
  const std::string other = (folder_ / "a.asc").string();
  write_file(other, "DSAA\n2 2\n0 1\n0 1\n0 3\n0 1\n2 3\n", true);  // Golden Software's ASCII grid
  EXPECT_THAT(refusal_of(other), HasSubstr("is of GDAL's driver GSAG"));
  EXPECT_THAT(refusal_of(other), HasSubstr("--gdal-driver GSAG"));
  set_raster_access({.drivers = {"GSAG"}});
  EXPECT_THAT(refusal_of(other), HasSubstr("states no CRS"));
  EXPECT_THAT([] { set_raster_access({.drivers = {"NoSuch"}}); },
              ThrowsMessage<UsageError>(HasSubstr("gdal_driver = \"NoSuch\" is no driver of this GDAL")));
}

TEST_F(RasterAccessTest, PipesAreNotWaitedFor) {
  const std::string pipe = (folder_ / "pipe.tif").string();
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THAT(refusal_of(pipe), HasSubstr("pipe.tif: is a pipe or a device"));
  ASSERT_EQ(::mkfifo((outside_ + ".msk").c_str(), 0600), 0);
  EXPECT_THAT(refusal_of(outside_), HasSubstr("b.tif.msk: is a pipe or a device"));
}

TEST_F(RasterAccessTest, AddressesAndFilesAreNoCrs) {
  write_file(folder_ / "utm.prj", Crs::from_user_input("EPSG:32633").wkt(), true);
  EXPECT_THROW(Crs::from_user_input((folder_ / "utm.prj").string()), UsageError);
  EXPECT_THROW(Crs::from_user_input("http://192.0.2.1/crs.wkt"), UsageError);
}

}  // namespace
}  // namespace pilotage
