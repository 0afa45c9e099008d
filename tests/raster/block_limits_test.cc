#include "pilotage/raster/block_limits.h"

#include <string>

#include "testing/error_of.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string blocks_error(const ImageryInfo& info, int value_bytes) {
  return testing::error_of<DataError>([&] { check_blocks(info, value_bytes); });
}

ImageryInfo raster(const char* driver, int width_px, int height_px, int block_width_px, int block_height_px) {
  ImageryInfo info;
  info.dataset = "wide.tif";
  info.driver = driver;
  info.width_px = width_px;
  info.height_px = height_px;
  info.block_width_px = block_width_px;
  info.block_height_px = block_height_px;
  return info;
}

TEST(BlockLimits, BlocksOfMoreThan512MebibytesAreRefused) {
  const int side = 1 << 14;  // 2^28 pixels
  EXPECT_EQ(blocks_error(raster("GTiff", side, side, side, side), 2), "") << "512 MiB and no more";
  EXPECT_THAT(blocks_error(raster("GTiff", side + 1, side, side + 1, side), 2),
              AllOf(HasSubstr("wide.tif: holds its 16385 x 16384 px in blocks of 16385 x 16384 px"),
                    HasSubstr("at most 536870912 are decoded at once; make tiles of it: gdal_translate")));
  EXPECT_EQ(blocks_error(raster("GTiff", 1 << 30, 1 << 30, 512, 512), 8), "") << "a large raster of small blocks";
}

TEST(BlockLimits, PicturesThatAreDecodedFromTheirTopMayNotBeLarge) {
  EXPECT_EQ(blocks_error(raster("JPEG", 1 << 15, 1 << 15, 1 << 15, 1), 1), "");
  EXPECT_THAT(blocks_error(raster("PNG", (1 << 15) + 1, 1 << 15, 1, 1), 1),
              HasSubstr("a PNG is decoded from its top for each part, so at most 1073741824 px are read"));
  EXPECT_EQ(blocks_error(raster("GTiff", (1 << 15) + 1, 1 << 15, 512, 512), 1), "");
}

}  // namespace
}  // namespace pilotage
