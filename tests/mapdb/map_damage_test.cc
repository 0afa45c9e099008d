// A map file cut short or with flipped bits: never a crash, never wrong contents that go unnoticed.

#include <fstream>

#include "mapdb/small_map.h"
#include "testing/temporary_folder.h"
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/random.h"
#include "pilotage/mapdb/map_inspect.h"
#include "pilotage/mapdb/map_reader.h"
#include "pilotage/mapdb/map_verify.h"

namespace pilotage {
namespace {

/// Everything a reader says about a file, as one string.
std::string read_all(const std::filesystem::path& path) {
  MapReader reader = MapReader::open_unverified(path);
  std::string all = to_json(inspect_map(path)).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  const auto add_number = [&](double number) { all.append(std::to_string(number)).append(" "); };
  for (const MapTile& tile : reader.tiles()) {
    for (const double number : {static_cast<double>(tile.tile_id), static_cast<double>(tile.level),
                                static_cast<double>(tile.column), static_cast<double>(tile.row), tile.bounds.min_x_m,
                                tile.bounds.max_y_m, tile.center.lon_deg, tile.center.lat_deg}) {
      add_number(number);
    }
    for (const double number : tile.enu_from_grid.reshaped()) add_number(number);
    for (const NearTile& near : reader.tiles_near(tile.center, 40)) add_number(near.distance_m);
    for (const NearTile& near : reader.tiles_near(tile.bounds.center_m(), 40)) add_number(near.distance_m);
    const auto values = reader.tile_values(tile.tile_id);
    for (const MapValue& value : values.value_or(std::vector<MapValue>())) {
      if (const auto* number = std::get_if<double>(&value)) add_number(*number);
      if (const auto* text = std::get_if<std::string>(&value)) all += *text;
    }
    if (const auto d = reader.descriptors(tile.tile_id, tile.level)) {
      for (const Feature& f : d->features.features) {
        add_number(static_cast<double>(f.x_px));
        add_number(static_cast<double>(f.y_px));
        add_number(static_cast<double>(f.octave));
      }
      for (const float height : d->ground_height_m) add_number(static_cast<double>(height));
      all.append(d->features.descriptors.begin(), d->features.descriptors.end());
    }
    if (const auto chip = reader.chip(tile.tile_id, tile.level)) all.append(chip->data.begin(), chip->data.end());
  }
  return all;
}

class MapDamage : public ::testing::Test {
 protected:
  MapDamage() : path_(folder_ / "map.gpkg"), damaged_(folder_ / "damaged.gpkg") {
    testing::write_map(path_, testing::make_small_map());
    bytes_ = read_file(path_);
    write_file(damaged_, bytes_, false);
  }

  /// Puts one byte into the copy.
  void put(std::size_t at, char byte) {
    std::fstream file(damaged_, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(static_cast<std::streamoff>(at));
    file.put(byte);
  }

  testing::TemporaryFolder folder_;
  std::filesystem::path path_;
  std::filesystem::path damaged_;
  std::string bytes_;
};

TEST_F(MapDamage, CutShortAtAnyByteIsRefused) {
  for (std::size_t size = bytes_.size(); size-- > 0;) {
    ASSERT_EQ(::truncate(damaged_.c_str(), static_cast<off_t>(size)), 0);
    ASSERT_THROW(MapReader::open_unverified(damaged_), DataError) << size;
    if (size % 1000 == 0) {
      ASSERT_FALSE(verify_map(damaged_).ok()) << size;
    }
  }
}

TEST_F(MapDamage, CutShortWithAHeaderThatAgreesIsNoticed) {
  const std::size_t page = 4096;
  for (std::size_t pages = 1; pages < bytes_.size() / page; ++pages) {
    std::string cut = bytes_.substr(0, pages * page);
    cut[30] = static_cast<char>(pages >> 8);
    cut[31] = static_cast<char>(pages & 255);
    write_file(damaged_, cut, true);
    EXPECT_FALSE(verify_map(damaged_).ok()) << pages;
  }
}

// A flip is found by verify_map or changes nothing that anyone reads.
TEST_F(MapDamage, FlippedBitsAreFoundOrHarmless) {
  const std::string whole = read_all(path_);
  Random random(seed_from_name("MapDamage.FlippedBits"));
  std::vector<std::size_t> places;
  for (std::size_t at = 0; at < 100; ++at) places.push_back(at);
  while (places.size() < 800) places.push_back(random.below(bytes_.size()));
  std::size_t found = 0;
  for (const std::size_t at : places) {
    put(at, static_cast<char>(bytes_[at] ^ (1 << random.below(8))));
    if (verify_map(damaged_).ok()) {
      // The file's own size is part of what inspect says, and the flip does not change it.
      std::string got = read_all(damaged_);
      const std::size_t name = got.find("damaged.gpkg");
      ASSERT_NE(name, std::string::npos);
      ASSERT_EQ(got.replace(name, 12, "map.gpkg"), whole) << "byte " << at;
    } else {
      ++found;
      try {
        static_cast<void>(read_all(damaged_));  // may be wrong, must not crash
      } catch (const DataError&) {
      }
    }
    put(at, bytes_[at]);
  }
  EXPECT_GT(found, places.size() / 10);
  EXPECT_TRUE(verify_map(damaged_).ok());
}

TEST_F(MapDamage, PagesOfNoiseDoNotCrash) {
  Random random(seed_from_name("MapDamage.Noise"));
  for (int trial = 0; trial < 100; ++trial) {
    std::string noisy = bytes_;
    const std::size_t start = random.below(noisy.size());
    const std::size_t end = std::min(noisy.size(), start + random.below(3000));
    for (std::size_t i = std::max<std::size_t>(start, 100); i < end; ++i)
      noisy[i] = static_cast<char>(random.below(256));
    write_file(damaged_, noisy, true);
    try {
      static_cast<void>(read_all(damaged_));
    } catch (const DataError&) {
    }
    static_cast<void>(verify_map(damaged_));
  }
}

}  // namespace
}  // namespace pilotage
