#include <cstdlib>

#include "mapdb/small_map.h"
#include "testing/temporary_folder.h"
#include <gtest/gtest.h>

#include "pilotage/mapdb/map_reader.h"
namespace pilotage {
TEST(Try, It) {
  write_map("/tmp/small.gpkg", testing::make_small_map(), true);
  MapReader reader("/tmp/small.gpkg");
  EXPECT_EQ(reader.tiles().size(), 12U);
  EXPECT_EQ(reader.descriptors(3, 0)->features.size(), 5U);
}
}  // namespace pilotage
