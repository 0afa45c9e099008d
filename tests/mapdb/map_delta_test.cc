#include "pilotage/mapdb/map_delta.h"

#include "mapdb/small_map.h"
#include "testing/error_of.h"
#include "testing/key_pair.h"
#include "testing/overwrite.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/file_digest.h"
#include "pilotage/base/output_file.h"
#include "pilotage/mapdb/map_delta_writer.h"
#include "pilotage/mapdb/map_reader.h"
#include "pilotage/mapdb/map_signing.h"

namespace pilotage {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using testing::error_of;
using ::testing::HasSubstr;
using testing::SmallMap;
using testing::SmallMapOptions;

/// The first of them.
void keep_features(TileDescriptors& tile, int count) {
  FeatureSet& features = tile.features;
  features.features.resize(static_cast<std::size_t>(count));
  features.descriptors.resize(static_cast<std::size_t>(count * features.descriptor_bytes));
  if (!tile.ground_height_m.empty()) tile.ground_height_m.resize(static_cast<std::size_t>(count));
}

/// The same ground without its westernmost tiles: the grid begins a tile further east, and all numbers are others.
SmallMap without_first_column(const SmallMap& map) {
  SmallMap rest = map;
  rest.tiles.clear();
  rest.values.clear();
  rest.descriptors.clear();
  rest.chips.clear();
  TileMatrix& matrix = rest.header.levels.front().matrix;
  matrix.map_from_pixel = matrix.map_from_pixel.shifted(matrix.stride_px, 0);
  matrix.grid_width_px -= matrix.stride_px;
  for (std::size_t i = 0; i < map.tiles.size(); ++i) {
    if (map.tiles[i].column == 0) continue;
    const auto number = static_cast<std::int64_t>(rest.tiles.size());
    rest.tiles.push_back(map.tiles[i]);
    rest.tiles.back().tile_id = number;
    rest.tiles.back().column -= 1;
    rest.values.push_back(map.values[i]);
    rest.descriptors.push_back(map.descriptors[i]);
    rest.descriptors.back().tile_id = number;
    rest.descriptors.back().window.col -= matrix.stride_px;
    rest.chips.push_back(map.chips[i]);
    rest.chips.back().tile_id = number;
    rest.chips.back().window.col -= matrix.stride_px;
  }
  return rest;
}

/// An old map, and a new one with another feature in one tile.
class MapDelta : public ::testing::Test {
 protected:
  MapDelta() : old_(folder_ / "old.gpkg"), new_(folder_ / "new.gpkg"), made_(folder_ / "made.gpkg") {
    key_ = testing::generate_key_pair(folder_ / "a.sec", folder_ / "a.pub");
    write(old_, 1, false);
    write(new_, 2, true);
  }

  void write(const fs::path& path, std::int64_t version, bool changed, const char* mission = "harbour") const {
    SmallMapOptions options;
    options.columns = 6;
    options.features_per_tile = 40;
    SmallMap map = testing::make_small_map(options);
    if (changed) {
      keep_features(map.descriptors[3], 39);
    }
    MapPurpose purpose;
    purpose.mission_name = mission;
    purpose.map_version = version;
    for (const MapInfoEntry& entry : purpose_entries(purpose)) map.info.push_back(entry);
    testing::write_map(path, map, true);
  }
  void write_delta(bool with_signature = false, std::uintmax_t chunks_above = kChunkListAboveBytes) const {
    std::optional<fs::path> signature;
    std::optional<fs::path> list;
    SignOptions options;
    options.overwrite = true;
    options.chunk_list_above_bytes = chunks_above;
    if (with_signature) {
      const SignatureFiles files = sign_file(new_, folder_ / "a.sec", options);
      signature = files.signature;
      list = files.chunk_list;
    }
    write_map_delta(delta(), old_, new_, signature, list);
    options.chunk_list_above_bytes = kChunkListAboveBytes;
    if (with_signature) sign_file(delta(), folder_ / "a.sec", options);
  }
  fs::path delta() const { return map_delta_path_of(new_); }
  MapUpdateOptions with_key() const {
    MapUpdateOptions options;
    options.trusted_keys = {key_};
    return options;
  }
  bool made_anything() const {
    return fs::exists(made_) || fs::exists(signature_path_of(made_)) || fs::exists(chunk_list_path_of(made_));
  }

  testing::TemporaryFolder folder_;
  fs::path old_;
  fs::path new_;
  fs::path made_;
  std::string key_;
};

TEST_F(MapDelta, MakesTheNewMapByteForByte) {
  write_delta();
  EXPECT_LT(fs::file_size(delta()), fs::file_size(new_) / 8);
  const MapUpdate made = update_map(old_, delta(), made_, {});
  EXPECT_TRUE(read_file(made_) == read_file(new_));
  EXPECT_EQ(made.bytes, fs::file_size(new_));
  EXPECT_EQ(made.digest, file_digest(new_));
  EXPECT_EQ(made.purpose.map_version, 2);
  EXPECT_FALSE(made.signature);
  EXPECT_FALSE(fs::exists(signature_path_of(made_)));
}

TEST_F(MapDelta, TheSameMapsGiveTheSameBytes) {
  write_delta();
  const std::string first = read_file(delta());
  write_delta();
  EXPECT_TRUE(read_file(delta()) == first);
}

TEST_F(MapDelta, BringsSignatureAndListOfChunks) {
  write_delta(true, 0);
  const MapUpdate made = update_map(old_, delta(), made_, with_key());
  ASSERT_TRUE(made.signature);
  EXPECT_EQ(made.signature->key_id, read_signed_map(new_, {key_}).signature().key_id);
  EXPECT_EQ(read_file(chunk_list_path_of(made_)), read_file(chunk_list_path_of(new_)));
  EXPECT_EQ(MapReader::open(made_, {key_}).purpose().map_version, 2);
}

// A power cut must leave one whole map: the old one stays, the new one has another name.
TEST_F(MapDelta, LeavesTheOldMap) {
  write_delta();
  const std::string before = read_file(old_);
  MapUpdateOptions options;
  options.overwrite = true;
  EXPECT_THAT(error_of<UsageError>([&] { update_map(old_, delta(), old_, options); }), HasSubstr("is the old map"));
  fs::create_hard_link(old_, made_);
  EXPECT_THAT(error_of<UsageError>([&] { update_map(old_, delta(), made_, options); }), HasSubstr("is the old map"));
  fs::remove(made_);
  update_map(old_, delta(), made_, options);
  EXPECT_TRUE(read_file(old_) == before);
  EXPECT_THAT(error_of<DataError>([&] { update_map(old_, delta(), made_, {}); }), HasSubstr("exists already"));
  update_map(old_, delta(), made_, options);
}

// The digest is of the map alone.
TEST_F(MapDelta, AListOfChunksOfAnotherMapIsRefused) {
  write_file(folder_ / "junk", "junk", false);
  write_map_delta(delta(), old_, new_, std::nullopt, folder_ / "junk");
  EXPECT_THAT(error_of<IntegrityError>([&] { update_map(old_, delta(), made_, {}); }),
              HasSubstr("its list of chunks is not that of the map that it makes"));
  EXPECT_FALSE(made_anything());
}

// Sixteen mebibytes of zeros are a few bytes: what says that it makes more than fits is refused before it is unpacked.
TEST_F(MapDelta, MoreThanTheDiskHoldsIsRefusedAtOnce) {
  write_delta();
  std::string content = read_file(delta());
  content[16 + 8 + 32 + 7] = '\x10';  // the highest byte of the new map's size
  testing::overwrite(delta(), content);
  EXPECT_THAT(error_of<DataError>([&] { update_map(old_, delta(), made_, {}); }), HasSubstr(" has room for "));
}

TEST_F(MapDelta, AnUnsignedOneIsRefusedWhereAKeyIsGiven) {
  write_delta();
  EXPECT_THAT(error_of<DataError>([&] { update_map(old_, delta(), made_, with_key()); }),
              HasSubstr("new.gpkg.delta.minisig: cannot be read"));
  // The delta signed, the map that it makes not.
  sign_file(delta(), folder_ / "a.sec");
  EXPECT_THAT(error_of<IntegrityError>([&] { update_map(old_, delta(), made_, with_key()); }),
              HasSubstr("the map that it makes is not signed"));
  // Signed, by somebody else.
  const std::string other = testing::generate_key_pair(folder_ / "b.sec", folder_ / "b.pub");
  MapUpdateOptions options;
  options.trusted_keys = {other};
  EXPECT_THAT(error_of<IntegrityError>([&] { update_map(old_, delta(), made_, options); }),
              HasSubstr("was made with key"));
  EXPECT_FALSE(made_anything());
}

TEST_F(MapDelta, AMapThatAnotherKeySignedIsRefused) {
  testing::generate_key_pair(folder_ / "b.sec", folder_ / "b.pub");
  const SignatureFiles files = sign_file(new_, folder_ / "b.sec");
  write_map_delta(delta(), old_, new_, files.signature, std::nullopt);
  sign_file(delta(), folder_ / "a.sec");
  EXPECT_THAT(error_of<IntegrityError>([&] { update_map(old_, delta(), made_, with_key()); }),
              AllOf(HasSubstr("made.gpkg.minisig: was made with key"), ::testing::Not(HasSubstr(".pilotage-"))));
  EXPECT_FALSE(made_anything());
}

TEST_F(MapDelta, OfAnotherMapItIsRefused) {
  write_delta();
  write(old_, 1, true);
  EXPECT_THAT(error_of<DataError>([&] { update_map(old_, delta(), made_, {}); }), HasSubstr("is not the map that"));
  EXPECT_FALSE(made_anything());
}

// A delta that was once rightly signed must not take an aircraft back.
TEST_F(MapDelta, AMapThatIsNotALaterOneIsRefused) {
  for (const std::int64_t version : {2, 3}) {
    write(old_, version, false);
    write_delta();
    EXPECT_THAT(error_of<IntegrityError>([&] { update_map(old_, delta(), made_, {}); }),
                HasSubstr("made.gpkg: is map version 2, and at least " + std::to_string(version + 1)));
  }
  EXPECT_FALSE(made_anything());
}

TEST_F(MapDelta, TheNewMapMustBeWhatIsRequired) {
  write_delta();
  MapUpdateOptions options;
  options.required.mission_name = "airfield";
  EXPECT_THAT(error_of<IntegrityError>([&] { update_map(old_, delta(), made_, options); }), HasSubstr("airfield"));
  write(new_, 2, true, "airfield");
  write_delta();
  EXPECT_THAT(error_of<IntegrityError>([&] { update_map(old_, delta(), made_, {}); }), HasSubstr("harbour"));
  EXPECT_FALSE(made_anything());
}

TEST_F(MapDelta, CutOffItIsRefusedEverywhere) {
  write_delta();
  const std::string content = read_file(delta());
  for (std::size_t size = 0; size < content.size(); size += size < 200 ? 1 : 211) {
    testing::overwrite(delta(), content.substr(0, size));
    EXPECT_THROW(update_map(old_, delta(), made_, {}), DataError) << size;
  }
  testing::overwrite(delta(), content + "x");
  EXPECT_THAT(error_of<DataError>([&] { update_map(old_, delta(), made_, {}); }), HasSubstr("goes on after its end"));
  EXPECT_FALSE(made_anything());
}

// Nobody's signature is checked here: the digests alone must hold, and nothing may be read that is not there.
TEST_F(MapDelta, EveryFlippedBitIsNoticed) {
  write_delta();
  const std::string content = read_file(delta());
  int unread = 0;
  for (std::size_t i = 0; i < content.size(); i += i < 200 ? 1 : 97) {
    std::string flipped = content;
    flipped[i] = static_cast<char>(flipped[i] ^ (1 << (i % 8)));
    testing::overwrite(delta(), flipped);
    try {
      update_map(old_, delta(), made_, {});
      EXPECT_TRUE(read_file(made_) == read_file(new_)) << i << ": a bit that zstd does not read";
      fs::remove(made_);
      ++unread;
    } catch (const DataError&) {
    }
  }
  EXPECT_LE(unread, 3);
  EXPECT_FALSE(made_anything());
}

TEST_F(MapDelta, StopsWhenAsked) {
  EXPECT_THROW(write_map_delta(delta(), old_, new_, std::nullopt, std::nullopt,
                               [](std::string_view, std::int64_t, std::int64_t) { return false; }),
               Interrupted);
  write_delta();
  EXPECT_THROW(update_map(old_, delta(), made_, {}, [](std::string_view, std::int64_t, std::int64_t) { return false; }),
               Interrupted);
  EXPECT_FALSE(made_anything());
}

TEST_F(MapDelta, TilesAreCountedByWhatIsStoredOfThem) {
  const auto difference = difference_of_maps(old_, new_);
  ASSERT_TRUE(difference);
  EXPECT_EQ(difference->changed, 1);
  EXPECT_EQ(difference->added, 0);
  EXPECT_EQ(difference->removed, 0);
  EXPECT_EQ(difference->same, 6 * 2 * 2 - 1);
}

TEST_F(MapDelta, TilesAreTheSameByPlaceWhateverTheirNumbers) {
  SmallMapOptions options;
  options.columns = 6;
  options.levels = 1;
  const SmallMap map = testing::make_small_map(options);
  testing::write_map(old_, map, true);
  testing::write_map(new_, without_first_column(map), true);
  const auto difference = difference_of_maps(old_, new_);
  ASSERT_TRUE(difference);
  EXPECT_EQ(difference->same, 5 * 2);
  EXPECT_EQ(difference->changed, 0);
  EXPECT_EQ(difference->added, 0);
  EXPECT_EQ(difference->removed, 2);
  const auto back = difference_of_maps(new_, old_);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->added, 2);
  EXPECT_EQ(back->removed, 0);
  options.tile_size_px /= 2;
  testing::write_map(new_, testing::make_small_map(options), true);
  EXPECT_EQ(difference_of_maps(old_, new_)->same + difference_of_maps(old_, new_)->changed, 0) << "of another size";
  options.northern_hemisphere = true;
  testing::write_map(new_, testing::make_small_map(options), true);
  EXPECT_FALSE(difference_of_maps(old_, new_)) << "another CRS";
}

TEST_F(MapDelta, AMapToUpdateIsReadBeforeTheWork) {
  MapPurpose purpose;
  purpose.map_version = 2;
  check_map_to_update(old_, purpose);
  purpose.map_version = 1;
  EXPECT_THAT(error_of<UsageError>([&] { check_map_to_update(old_, purpose); }),
              HasSubstr("is map version 1; give a larger --map-version than 1"));
  EXPECT_THAT(error_of<UsageError>([&] { check_map_to_update(old_, {}); }), HasSubstr("give a larger --map-version"));
  testing::overwrite(old_, "no map");
  EXPECT_THROW(check_map_to_update(old_, purpose), DataError);
}

// Larger than a window, with everything moved by what came before it: the right part of the old map is found.
TEST(MapDeltaThorough, FindsWhatMovedInALargeMap) {
  const testing::TemporaryFolder folder;
  SmallMapOptions options;
  options.columns = 12;
  options.rows = 12;
  options.levels = 1;
  options.features_per_tile = 32'000;
  options.tile_size_px = 512;
  SmallMap map = testing::make_small_map(options);
  testing::write_map(folder / "old.gpkg", map);
  ASSERT_GT(fs::file_size(folder / "old.gpkg"), std::uintmax_t{100} << 20);
  for (std::size_t tile = 0; tile < 70; ++tile) {  // half of the map shrinks
    keep_features(map.descriptors[tile], 100);
  }
  testing::write_map(folder / "new.gpkg", map);
  write_map_delta(folder / "new.gpkg.delta", folder / "old.gpkg", folder / "new.gpkg", std::nullopt, std::nullopt);
  EXPECT_LT(fs::file_size(folder / "new.gpkg.delta"), fs::file_size(folder / "new.gpkg") / 50);
  update_map(folder / "old.gpkg", folder / "new.gpkg.delta", folder / "made.gpkg", {});
  EXPECT_EQ(file_digest(folder / "made.gpkg"), file_digest(folder / "new.gpkg"));
}

}  // namespace
}  // namespace pilotage
