#include "pilotage/mapdb/map_writer.h"

#include <csignal>
#include <cstdlib>
#include <functional>

#include "mapdb/small_map.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "pilotage/base/error.h"
#include "pilotage/mapdb/map_reader.h"
#include "pilotage/mapdb/map_verify.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

std::ptrdiff_t files_in(const std::filesystem::path& folder) {
  return std::distance(std::filesystem::directory_iterator(folder), {});
}

TEST(MapWriter, SameContentsGiveTheSameBytes) {
  const testing::TemporaryFolder folder;
  const testing::SmallMap map = testing::make_small_map();
  const std::string first = testing::write_map(folder / "a.gpkg", map);
  const std::string second = testing::write_map(folder / "b.gpkg", map);
  EXPECT_EQ(first, second);
  EXPECT_EQ(read_file(folder / "a.gpkg"), read_file(folder / "b.gpkg"));
}

TEST(MapWriter, DatesComeFromTheEnvironment) {
  const testing::TemporaryFolder folder;
  const testing::SmallMap map = testing::make_small_map();
  testing::write_map(folder / "a.gpkg", map);
  ::setenv("SOURCE_DATE_EPOCH", "1700000000", 1);
  testing::write_map(folder / "b.gpkg", map);
  ::setenv("SOURCE_DATE_EPOCH", "yesterday", 1);
  EXPECT_THROW(testing::write_map(folder / "c.gpkg", map), UsageError);
  ::unsetenv("SOURCE_DATE_EPOCH");
  EXPECT_THAT(read_file(folder / "a.gpkg"), HasSubstr("1970-01-01T00:00:00.000Z"));
  EXPECT_THAT(read_file(folder / "b.gpkg"), HasSubstr("2023-11-14T22:13:20.000Z"));
  EXPECT_FALSE(std::filesystem::exists(folder / "c.gpkg"));
}

TEST(MapWriter, RefusesToReplaceUnlessTold) {
  const testing::TemporaryFolder folder;
  const testing::SmallMap map = testing::make_small_map();
  testing::write_map(folder / "a.gpkg", map);
  EXPECT_THROW(testing::write_map(folder / "a.gpkg", map), DataError);
  testing::write_map(folder / "a.gpkg", map, true);
  EXPECT_THROW(testing::write_map(folder / "nowhere" / "a.gpkg", map), DataError);
}

TEST(MapWriter, LeavesNothingWhenItIsNotFinished) {
  const testing::TemporaryFolder folder;
  const testing::SmallMap map = testing::make_small_map();
  {
    MapWriter writer(folder / "a.gpkg", map.header, false);
    writer.add_tile(map.tiles[0], map.values[0]);
    EXPECT_FALSE(std::filesystem::exists(folder / "a.gpkg"));
  }
  EXPECT_EQ(files_in(folder.path()), 0);
}

TEST(MapWriter, LeavesNothingUnderTheNameWhenKilled) {
  const testing::TemporaryFolder folder;
  const testing::SmallMap map = testing::make_small_map();
  const pid_t child = ::fork();
  if (child == 0) {
    MapWriter writer(folder / "a.gpkg", map.header, false);
    writer.add_tile(map.tiles[0], map.values[0]);
    ::kill(::getpid(), SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_FALSE(std::filesystem::exists(folder / "a.gpkg"));
}

// A limit on the size of files fails writes as a full disk does.
TEST(MapWriter, FullDiskIsAnErrorAndLeavesNothing) {
  const testing::TemporaryFolder folder;
  testing::SmallMapOptions options;
  options.features_per_tile = 2000;
  const testing::SmallMap map = testing::make_small_map(options);
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  auto* handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit tight{200000, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &tight), 0);
  EXPECT_THROW(testing::write_map(folder / "a.gpkg", map), DataError);
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(files_in(folder.path()), 0);
}

TEST(MapWriter, EmptyMapIsAMap) {
  const testing::TemporaryFolder folder;
  MapHeader header = testing::make_small_map().header;
  header.tile_columns.clear();
  header.chips = false;
  MapWriter(folder / "a.gpkg", header, false).finish();
  MapReader reader = MapReader::open_unverified(folder / "a.gpkg");
  EXPECT_TRUE(reader.tiles().empty());
  EXPECT_FALSE(reader.has_chips());
  EXPECT_TRUE(verify_map(folder / "a.gpkg").ok());
}

TEST(MapWriter, CrsWithoutAuthorityAndInWkt2) {
  const testing::TemporaryFolder folder;
  testing::SmallMap map = testing::make_small_map();
  map.header.crs = {"Corridor", "PROJCRS[\"Corridor\",BASEGEOGCRS[\"WGS 84\"]]", ""};
  testing::write_map(folder / "a.gpkg", map);
  EXPECT_EQ(MapReader::open_unverified(folder / "a.gpkg").info().crs.wkt, map.header.crs.wkt);
  EXPECT_EQ(MapReader::open_unverified(folder / "a.gpkg").info().crs.authority, "");
  EXPECT_TRUE(verify_map(folder / "a.gpkg").ok());
}

struct BadCall {
  const char* message;
  std::function<void(MapWriter&, testing::SmallMap&)> call;
};

TEST(MapWriter, RefusesWrongRows) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<BadCall> calls = {
      {"tile 0: comes after tile 0", [](auto& w, auto& m) { w.add_tile(m.tiles[0], m.values[0]); }},
      {"tile -1: a tile_id is at least 0",
       [](auto& w, auto& m) {
         m.tiles[1].tile_id = -1;
         w.add_tile(m.tiles[1], m.values[1]);
       }},
      {"tile 1: level 7 is not one",
       [](auto& w, auto& m) {
         m.tiles[1].level = 7;
         w.add_tile(m.tiles[1], m.values[1]);
       }},
      {"enclose no area",
       [nan](auto& w, auto& m) {
         m.tiles[1].bounds.min_x_m = nan;
         w.add_tile(m.tiles[1], m.values[1]);
       }},
      {"is not on Earth",
       [](auto& w, auto& m) {
         m.tiles[1].center.lat_deg = 91;
         w.add_tile(m.tiles[1], m.values[1]);
       }},
      {"is not that of a map projection",
       [](auto& w, auto& m) {
         m.tiles[1].enu_from_grid(0, 0) *= -1;
         w.add_tile(m.tiles[1], m.values[1]);
       }},
      {"tile 1: has 1 values for 4 columns", [](auto& w, auto& m) { w.add_tile(m.tiles[1], {1.0}); }},
      {"column rivals is INTEGER, but is given a number",
       [](auto& w, auto& m) {
         w.add_tile(m.tiles[1], {1.0, 1.0, 1.0, std::string()});
       }},
      {"column status: the text is not UTF-8",
       [](auto& w, auto& m) {
         w.add_tile(m.tiles[1], {1.0, 1.0, std::int64_t{1}, std::string("\xE0\x80\x80")});
       }},
      {"its tile has not been added", [](auto& w, auto& m) { w.add_descriptors(m.descriptors[1]); }},
      {"must come in ascending order", [](auto& w, auto& m) { w.add_descriptors(m.descriptors[0]); }},
      {"outside the footprint",
       [](auto& w, auto& m) {
         m.descriptors[0].level = 1;
         m.descriptors[0].window.col += 64;
         w.add_descriptors(m.descriptors[0]);
       }},
      {"outside its window",
       [](auto& w, auto& m) {
         w.add_tile(m.tiles[1], m.values[1]);
         m.descriptors[1].features.features[2].x_px = 64.1F;
         w.add_descriptors(m.descriptors[1]);
       }},
      {"window of 0 × 64 px",
       [](auto& w, auto& m) {
         m.descriptors[0].window.width = 0;
         w.add_descriptors(m.descriptors[0]);
       }},
      {"chip blob has 11 bytes",
       [](auto& w, auto& m) {
         m.chips[0].data.pop_back();
         w.add_chip(m.chips[0]);
       }},
      {"ids must ascend",
       [](auto& w, auto& m) {
         w.write_route({}, {m.legs[1], m.legs[0]});
       }},
      {"has less than two points",
       [](auto& w, auto& m) {
         m.legs[0].points.resize(1);
         w.write_legs({}, m.legs);
       }},
      {"given twice", [](auto& w, auto&) { w.add_info("tool", "again"); }},
      {"written by the map itself", [](auto& w, auto&) { w.add_info("content_digest", "0"); }},
      {"legs: column \"fid\": the name is one that every map has",
       [](auto& w, auto& m) {
         w.write_legs({{"fid", MapColumnType::kReal, ""}}, m.legs);
       }},
      {"legs: column \"a b\": a name is",
       [](auto& w, auto& m) {
         w.write_legs({{"a b", MapColumnType::kReal, ""}}, m.legs);
       }},
  };
  const testing::TemporaryFolder folder;
  for (const BadCall& bad : calls) {
    testing::SmallMap map = testing::make_small_map();
    MapWriter writer(folder / "a.gpkg", map.header, false);
    writer.add_info("tool", "test");
    writer.add_tile(map.tiles[0], map.values[0]);
    writer.add_descriptors(map.descriptors[0]);
    EXPECT_THAT([&] { bad.call(writer, map); }, ThrowsMessage<UsageError>(HasSubstr(bad.message)));
  }
  EXPECT_EQ(files_in(folder.path()), 0);
}

TEST(MapWriter, RefusesWrongHeaders) {
  const testing::TemporaryFolder folder;
  const auto expect = [&](const char* message, const std::function<void(MapHeader&)>& change) {
    MapHeader header = testing::make_small_map().header;
    change(header);
    EXPECT_THAT([&] { MapWriter(folder / "a.gpkg", header, false); }, ThrowsMessage<UsageError>(HasSubstr(message)));
  };
  expect("a map has 1 to 64", [](MapHeader& h) { h.levels.clear(); });
  expect("ascending order", [](MapHeader& h) { std::swap(h.levels[0], h.levels[1]); });
  expect("cannot be inverted", [](MapHeader& h) { h.levels[0].matrix.map_from_pixel.x_per_col = 0; });
  expect("gsd_m = 0 is outside", [](MapHeader& h) { h.levels[0].gsd_m = 0; });
  expect("stride_px = 0", [](MapHeader& h) { h.levels[0].matrix.stride_px = 0; });
  expect("crs", [](MapHeader& h) { h.crs.wkt.clear(); });
  expect("given twice", [](MapHeader& h) { h.tile_columns.push_back(h.tile_columns[0]); });
  expect("every map has already", [](MapHeader& h) { h.tile_columns[0].name = "center_lon_deg"; });
  EXPECT_EQ(files_in(folder.path()), 0);
}

}  // namespace
}  // namespace pilotage
