#include "pilotage/report/tile_fields.h"

#include <limits>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/ground/measures.h"

namespace pilotage {
namespace {

TEST(TileFields, TheReportsOwnAndEveryMeasureOnce) {
  std::vector<std::string> own;
  std::set<std::string> measured;
  for (const TileField& field : tile_fields()) {
    if (find_measure(field.name) == nullptr && field.name != "valid_fraction") {
      own.push_back(field.name);
    } else {
      EXPECT_TRUE(measured.insert(field.name).second) << field.name;
    }
  }
  EXPECT_THAT(own, ::testing::ElementsAre("tile_id", "level", "column", "row", "selected", "status", "reason",
                                          "reasons", "half_found_until", "center_lon_deg", "center_lat_deg",
                                          "route_distance_m", "route_offset_m"));
  EXPECT_EQ(measured.size(), measures().size() + 1);
}

TEST(TileFields, ValuesAreOfTheirType) {
  ReportTile tile;
  tile.half_found_until = "2027-03-14";
  for (const Measure& measure : measures()) measure.set(tile.score, 0.25);
  for (const TileField& field : tile_fields()) {
    // NULL, boolean, integer, real, text: the order of VectorValue is that of VectorType after NULL.
    EXPECT_EQ(field.value(tile).index(), static_cast<std::size_t>(field.type) + 1) << field.name;
  }
  for (const TileField& field : tile_fields()) {
    if (find_measure(field.name) != nullptr || field.name == "half_found_until") {
      EXPECT_EQ(field.value(ReportTile{}), VectorValue()) << field.name << " of a tile that was not measured";
    }
  }
}

TEST(Rounded, KeepsSignificantDigits) {
  EXPECT_EQ(rounded(1234567.0, 6), 1234570.0);
  EXPECT_EQ(rounded(0.000123456789, 6), 0.000123457);
  EXPECT_EQ(rounded(2.718281828459045, 12), 2.71828182846);
  EXPECT_FALSE(std::signbit(rounded(-0.0, 6)));
  EXPECT_EQ(number_value(std::numeric_limits<double>::infinity()), VectorValue());
  EXPECT_EQ(degrees_value(7.123456789), VectorValue(7.1234568));
}

}  // namespace
}  // namespace pilotage
