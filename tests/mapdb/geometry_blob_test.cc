#include "pilotage/mapdb/geometry_blob.h"

#include <cmath>

#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"

namespace pilotage {
namespace {

using Line = std::vector<GeodeticPoint>;

TEST(CutAtAntimeridian, LeavesOtherLinesAlone) {
  const Line line = {{10, 1}, {20, 2}, {-100, 3}};
  const auto parts = cut_at_antimeridian(line);
  ASSERT_EQ(parts.size(), 1U);
  ASSERT_EQ(parts[0].size(), 3U);
  EXPECT_EQ(parts[0][2].lon_deg, -100);
}

TEST(CutAtAntimeridian, CutsEastAndWest) {
  for (const double sign : {1.0, -1.0}) {
    const auto parts = cut_at_antimeridian({{sign * 179, 10}, {-sign * 179, 20}, {-sign * 178, 20}});
    ASSERT_EQ(parts.size(), 2U);
    ASSERT_EQ(parts[0].size(), 2U);
    ASSERT_EQ(parts[1].size(), 3U);
    EXPECT_EQ(parts[0][1].lon_deg, sign * 180);
    EXPECT_NEAR(parts[0][1].lat_deg, 15, 1e-12);
    EXPECT_EQ(parts[1][0].lon_deg, -sign * 180);
    EXPECT_NEAR(parts[1][0].lat_deg, 15, 1e-12);
    EXPECT_NEAR(parts[1][1].lon_deg, -sign * 179, 1e-12);
  }
}

TEST(CutAtAntimeridian, LeavesNoPartWithoutLength) {
  EXPECT_EQ(cut_at_antimeridian({{180, 0}, {179, 0}}).size(), 1U);
  EXPECT_EQ(cut_at_antimeridian({{-180, 0}, {179, 0}}).size(), 1U);
  EXPECT_EQ(cut_at_antimeridian({{179, 0}, {180, 0}}).size(), 1U);
  EXPECT_EQ(cut_at_antimeridian({{180, 0}, {180, 0}}).size(), 1U);
  EXPECT_EQ(cut_at_antimeridian({{5, 0}, {5, 0}}).at(0).size(), 2U);
}

TEST(CutAtAntimeridian, AnyWalkStaysOnEarthAndKeepsItsLength) {
  Random random(seed_from_name("CutAtAntimeridian.AnyWalk"));
  for (int trial = 0; trial < 500; ++trial) {
    Line line = {{random.uniform(-180, 180), random.uniform(-80, 80)}};
    double length = 0;
    while (line.size() < 12) {
      const double step = random.uniform(-120, 120);
      length += std::abs(step);
      line.push_back({wrap_lon_deg(line.back().lon_deg + step), line.back().lat_deg});
    }
    double cut_length = 0;
    for (const Line& part : cut_at_antimeridian(line)) {
      ASSERT_GE(part.size(), 2U);
      for (std::size_t i = 0; i < part.size(); ++i) {
        ASSERT_LE(std::abs(part[i].lon_deg), 180);
        if (i > 0) cut_length += std::abs(part[i].lon_deg - part[i - 1].lon_deg);
      }
    }
    EXPECT_NEAR(cut_length, length, 1e-9);
  }
}

TEST(LineBlob, IsReadBackAndRefusedWhenCutShort) {
  const std::vector<Line> one = {{{1, 2}, {3, 4}, {5, 6}}};
  const std::vector<Line> two = {{{1, 2}, {3, 4}}, {{5, 6}, {7, 8}}};
  for (const auto& [parts, multi] : {std::pair{one, false}, {one, true}, {two, true}}) {
    const auto blob = line_blob(parts, multi);
    const auto back = parse_line_blob(blob, "here");
    ASSERT_EQ(back.size(), parts.size());
    EXPECT_EQ(back.back().back().lon_deg, parts.back().back().lon_deg);
    for (std::size_t size = 0; size < blob.size(); ++size) {
      EXPECT_THROW(parse_line_blob(std::span(blob).first(size), "here"), DataError) << size;
    }
    auto longer = blob;
    longer.push_back(0);
    EXPECT_THROW(parse_line_blob(longer, "here"), DataError);
  }
}

TEST(PolygonBlob, IsTheOutline) {
  // "GP", version 0, flags 3, srs_id 32750; envelope and WKB little-endian
  const auto blob = polygon_blob({1, 2, 3, 4}, 32750);
  ASSERT_EQ(blob.size(), 40U + 9 + 4 + 5 * 16);
  EXPECT_EQ(blob[0], 'G');
  EXPECT_EQ(blob[3], 3);
  EXPECT_EQ(blob[4] + 256 * blob[5], 32750);
  EXPECT_EQ(blob[40], 1);
  EXPECT_EQ(blob[41], 3);
}

}  // namespace
}  // namespace pilotage
