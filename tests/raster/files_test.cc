#include <filesystem>
#include <fstream>

#include "raster/raster_maker.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/file_digest.h"
#include "pilotage/base/output_file.h"
#include "pilotage/raster/gdal_files.h"
#include "pilotage/raster/gdal_imagery.h"

namespace pilotage {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

class DatasetFiles : public ::testing::Test {
 protected:
  DatasetFiles() : raster_(testing::make_raster(folder_ / "a.tif", {})) {}

  std::string beside(const std::string& suffix, const std::string& content) const {
    write_file(raster_ + suffix, content, true);
    return raster_ + suffix;
  }
  /// Another place, 20 m east of the raster's own.
  std::string move_by_pam() const {
    return beside(".aux.xml",
                  "<PAMDataset><GeoTransform>500020, 0.5, 0, 5000000, 0, -0.5</GeoTransform></PAMDataset>\n");
  }
  /// A mask that leaves the left half out.
  std::string add_mask() const {
    testing::RasterSpec mask;
    mask.georeferenced = false;
    mask.srs = "";
    mask.value = [](int, int col, int) { return col < 30 ? 0 : 255; };
    mask.finish = [](GDALDataset& dataset) { dataset.SetMetadataItem("INTERNAL_MASK_FLAGS_1", "2"); };
    return testing::make_raster(raster_ + ".msk", mask);
  }

  testing::TemporaryFolder folder_;
  std::string raster_;
};

TEST_F(DatasetFiles, OneFileHasTheDigestOfThatFile) {
  EXPECT_THAT(dataset_files(raster_), ElementsAre(raster_));
  EXPECT_EQ(dataset_digest(raster_), "blake2b-256:" + file_digest(raster_));
}

TEST_F(DatasetFiles, WhatLiesBesideCountsAndChangesTheDigest) {
  const std::string alone = dataset_digest(raster_);
  const std::string pam = move_by_pam();
  EXPECT_THAT(dataset_files(raster_), ElementsAre(raster_, pam));
  const std::string moved = dataset_digest(raster_);
  EXPECT_NE(moved, alone);
  // What `b2sum -l 256 a.tif a.tif.aux.xml | b2sum -l 256` prints.
  EXPECT_EQ(moved, "blake2b-256-of-list:" +
                       bytes_digest(file_digest(raster_) + "  a.tif\n" + file_digest(pam) + "  a.tif.aux.xml\n"));
  write_file(pam, read_file(pam) + " ", true);
  EXPECT_NE(dataset_digest(raster_), moved);
  const std::string mask = add_mask();
  EXPECT_THAT(dataset_files(raster_), Contains(mask));
}

TEST_F(DatasetFiles, SourcesOfAVrtAndWhatLiesBesideThemCount) {
  const std::string vrt = (folder_ / "mosaic.vrt").string();
  write_file(vrt,
             "<VRTDataset rasterXSize=\"60\" rasterYSize=\"40\"><VRTRasterBand dataType=\"Byte\" band=\"1\">"
             "<SimpleSource><SourceFilename relativeToVRT=\"1\">a.tif</SourceFilename><SourceBand>1</SourceBand>"
             "</SimpleSource></VRTRasterBand></VRTDataset>",
             false);
  EXPECT_THAT(dataset_files(vrt), ElementsAre(vrt, raster_));
  const std::string before = dataset_digest(vrt);
  const std::string pam = move_by_pam();
  EXPECT_THAT(dataset_files(vrt), ElementsAre(vrt, raster_, pam));
  EXPECT_NE(dataset_digest(vrt), before);
}

TEST_F(DatasetFiles, WhatIsNotAFileHereHasNoDigest) {
  EXPECT_THAT(dataset_files("<VRTDataset rasterXSize=\"4\" rasterYSize=\"4\">"
                            "<VRTRasterBand dataType=\"Byte\" band=\"1\"/></VRTDataset>"),
              IsEmpty());
  EXPECT_THROW(dataset_files((folder_ / "none.tif").string()), DataError);
}

TEST_F(DatasetFiles, AFileBesideThatMovesTheRasterIsNamed) {
  EXPECT_THAT(inspect_imagery(raster_).warnings, IsEmpty());
  const std::string pam = move_by_pam();
  const ImageryInfo info = inspect_imagery(raster_);
  EXPECT_EQ(info.map_from_pixel.origin_x, 500020);
  EXPECT_THAT(info.warnings,
              Contains(HasSubstr(pam + " puts it up to 20 units of its CRS from where the file itself")));
}

// Without its mask every pixel would be ground, and nobody would be told.
TEST_F(DatasetFiles, AMaskThatCannotBeOpenedIsAnError) {
  const std::string mask = add_mask();
  EXPECT_EQ(inspect_imagery(raster_).mask, MaskKind::kMaskBand);
  write_file(mask, "what a bad medium gives", true);
  EXPECT_THAT(
      [&] { inspect_imagery(raster_); },
      ThrowsMessage<DataError>(HasSubstr("a.tif.msk: lies beside the raster as its mask, but cannot be opened")));
}

}  // namespace
}  // namespace pilotage
