// A second reader, written from schemas/ alone, must see what ours sees.

#include <bit>
#include <cmath>
#include <cstdio>

#include "mapdb/run_command.h"
#include "mapdb/small_map.h"
#include "testing/source_folder.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/mapdb/map_reader.h"

namespace pilotage {
namespace {

using testing::run_command;

std::string line_of(const TileDescriptors& d, std::size_t i) {
  const Feature& f = d.features.features[i];
  int bits = 0;
  for (int k = 0; k < d.features.descriptor_bytes; ++k) bits += std::popcount(d.features.descriptor(i)[k]);
  const bool known = !d.ground_height_m.empty() && !std::isnan(d.ground_height_m[i]);
  const std::string height = known ? format_fixed(static_cast<double>(d.ground_height_m[i]), 1) : "-";
  std::array<char, 200> line{};
  std::snprintf(line.data(), line.size(), "%lld %d %.4f %.4f %d %s %d\n", static_cast<long long>(d.tile_id), d.level,
                static_cast<double>(f.x_px), static_cast<double>(f.y_px), f.octave, height.c_str(), bits);
  return line.data();
}

TEST(MapSpecification, IsEnoughForAnotherReader) {
  if (run_command("/usr/bin/python3 -c 'import sqlite3, hashlib'").status != 0)
    GTEST_SKIP() << "Python is not installed: apt-get install python3";
  const testing::TemporaryFolder folder;
  const auto path = folder / "map.gpkg";
  testing::write_map(path, testing::make_small_map());
  MapReader reader = MapReader::open_unverified(path);
  std::string ours;
  for (const MapTile& tile : reader.tiles()) {
    const TileDescriptors d = *reader.descriptors(tile.tile_id, tile.level);
    for (std::size_t i = 0; i < d.features.size(); ++i) ours += line_of(d, i);
  }
  const std::string command =
      "/usr/bin/python3 " + (testing::source_folder() / "tests/mapdb/check_by_specification.py ").string();
  const auto outcome = run_command(command + path.string());
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_EQ(outcome.output, ours);

  std::string bytes = read_file(path);
  bytes[bytes.size() - 1] = static_cast<char>(bytes[bytes.size() - 1] ^ 1);  // the last page is full of rows to its end
  write_file(path, bytes, true);
  EXPECT_NE(run_command(command + path.string()).status, 0);
}

}  // namespace
}  // namespace pilotage
