// A map that is signed with a list of its chunks is read chunk by chunk, each checked when it is read.

#include <fstream>

#include "mapdb/small_map.h"
#include "testing/key_pair.h"
#include "testing/overwrite.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/random.h"
#include "pilotage/mapdb/chunked_file.h"
#include "pilotage/mapdb/map_reader.h"
#include "pilotage/mapdb/map_signing.h"
#include "pilotage/mapdb/map_verify.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class ChunkedMap : public ::testing::Test {
 protected:
  ChunkedMap() : path_(folder_ / "map.gpkg"), list_(folder_ / "map.gpkg.chunks") {
    testing::SmallMapOptions layout;
    layout.columns = 12;
    layout.rows = 10;
    layout.features_per_tile = 60;
    map_ = testing::make_small_map(layout);
    map_.content_digest = testing::write_map(path_, map_);
    key_ = testing::generate_key_pair(folder_ / "a.key", folder_ / "a.pub");
    sign(0);
    content_ = read_file(path_);
  }

  SignatureFiles sign(std::uintmax_t above_bytes) const {
    SignOptions options;
    options.chunk_list_above_bytes = above_bytes;
    options.overwrite = true;
    return sign_file(path_, folder_ / "a.key", options);
  }

  /// All that the map holds of its tiles, as a reader gives it.
  std::size_t read_everything() const {
    MapReader reader = MapReader::open(path_, {key_}, 0);
    std::size_t bytes = 0;
    for (const MapTile& tile : reader.tiles()) {
      bytes += reader.tile_values(tile.tile_id)->size() + reader.tiles_near(tile.center, 30).size();
      if (const auto found = reader.descriptors(tile.tile_id, tile.level)) {
        bytes += found->features.descriptors.size();
      }
      if (const auto chip = reader.chip(tile.tile_id, tile.level)) bytes += chip->data.size();
    }
    return bytes;
  }

  testing::TemporaryFolder folder_;
  std::filesystem::path path_;
  std::filesystem::path list_;
  testing::SmallMap map_;
  std::string key_;
  std::string content_;
};

TEST_F(ChunkedMap, ReadsAsFromMemory) {
  ASSERT_GT(content_.size(), 4 * kChunkBytes) << "several chunks, and the last one is short";
  ASSERT_NE(content_.size() % kChunkBytes, 0U);
  EXPECT_EQ(read_file(list_).size(), kChunkListHeaderBytes + kChunkDigestBytes * chunk_count(content_.size()));
  const SignedMap chunked = read_signed_map(path_, {key_});
  EXPECT_EQ(chunked.bytes(), nullptr);
  EXPECT_EQ(chunked.size(), content_.size());
  const VerifyReport report = verify_map(chunked);
  EXPECT_TRUE(report.ok());
  EXPECT_EQ(report.content_digest, map_.content_digest);
  const std::size_t read = read_everything();
  EXPECT_FALSE(sign(content_.size()).chunk_list);
  EXPECT_FALSE(std::filesystem::exists(list_)) << "no list of an earlier signature is left";
  EXPECT_NE(read_signed_map(path_, {key_}).bytes(), nullptr);
  EXPECT_EQ(read_everything(), read);
}

TEST_F(ChunkedMap, TheListIsTheDigestsOfItsChunks) {
  const std::string list = read_file(list_);
  EXPECT_TRUE(list.starts_with(kChunkListMagic));
  const std::string comment = read_signed_map(path_, {key_}).signature().trusted_comment;
  EXPECT_EQ(comment, "file:map.gpkg\thashed\t" + chunk_list_mark(list));
  // BLAKE2b-256 of 65536 zero bytes, from `head -c 65536 /dev/zero | b2sum -l 256`
  write_file(folder_ / "zeros", std::string(kChunkBytes, '\0'), false);
  SignOptions options;
  options.chunk_list_above_bytes = 0;
  const auto files = sign_file(folder_ / "zeros", folder_ / "a.key", options);
  const std::string digest = read_file(*files.chunk_list).substr(kChunkListHeaderBytes);
  EXPECT_EQ(digest.size(), kChunkDigestBytes);
  EXPECT_EQ(digest.substr(0, 4), "\xdf\x2d\x0b\x4e");
}

TEST_F(ChunkedMap, NoticesEveryByteOfMapListAndSignature) {
  Random random(seed_from_name("ChunkedMap"));
  for (int i = 0; i < 300; ++i) {
    std::string changed = content_;
    const auto at = static_cast<std::size_t>(random.below(content_.size()));
    changed[at] = static_cast<char>(changed[at] ^ (1 << random.below(8)));
    testing::overwrite(path_, changed);
    const VerifyReport report = verify_map(read_signed_map(path_, {key_}));
    ASSERT_TRUE(report.any_wrong_digest()) << at;
    EXPECT_THAT(report.problems.front().message, HasSubstr("are not those that were signed")) << at;
  }
  for (int i = 0; i < 50; ++i) {
    testing::overwrite(path_, content_.substr(0, static_cast<std::size_t>(random.below(content_.size()))));
    EXPECT_THROW(read_signed_map(path_, {key_}), IntegrityError);
  }
  testing::overwrite(path_, content_ + "x");
  EXPECT_THROW(read_signed_map(path_, {key_}), IntegrityError);
  testing::overwrite(path_, content_);
  for (const auto& file : {list_, folder_ / "map.gpkg.minisig"}) {
    const std::string content = read_file(file);
    for (std::size_t i = 0; i < content.size(); ++i) {
      if (file != list_ && i > 18 && i < content.find('\n')) continue;  // the text of the untrusted comment
      std::string flipped = content;
      flipped[i] = static_cast<char>(flipped[i] ^ (1 << (i % 7)));
      testing::overwrite(file, flipped);
      EXPECT_THROW(read_signed_map(path_, {key_}), DataError) << file << " " << i;
      if (file != list_ && i + 1 == content.size()) break;  // the last line end may be missing
      testing::overwrite(file, content.substr(0, i));
      EXPECT_THROW(read_signed_map(path_, {key_}), DataError) << file << " cut to " << i;
    }
    testing::overwrite(file, content);
  }
  EXPECT_GT(read_everything(), 0U);
}

// The map is exchanged after it was opened: nothing lies between the check of a chunk and its use.
TEST_F(ChunkedMap, AReaderNoticesWhatChangesWhileItIsOpen) {
  MapReader reader = MapReader::open(path_, {key_}, 0);
  const auto before = reader.descriptors(0, 0);
  ASSERT_NE(before, nullptr);
  const std::string other(content_.size(), 'x');
  // In place, as no program of ours writes.
  std::ofstream(path_, std::ios::binary | std::ios::in).write(other.data(), static_cast<std::streamsize>(other.size()));
  std::size_t noticed = 0;
  for (const MapTile& tile : map_.tiles) {
    try {
      const auto found = reader.descriptors(tile.tile_id, tile.level);
      ASSERT_NE(found, nullptr);
    } catch (const IntegrityError& error) {
      EXPECT_THAT(error.what(), HasSubstr("map.gpkg: bytes "));
      ++noticed;
    }
  }
  EXPECT_GT(noticed, 0U);
  EXPECT_THROW(MapReader::open(path_, {key_}), IntegrityError);
}

TEST_F(ChunkedMap, SeveralReadersShareAFile) {
  const SignedMap map = read_signed_map(path_, {key_});
  MapReader first = MapReader::open(map, 0);
  MapReader second = MapReader::open(map, 0);
  std::filesystem::remove(path_);  // it is held open
  for (const MapTile& tile : map_.tiles) {
    ASSERT_NE(first.descriptors(tile.tile_id, tile.level), nullptr);
    EXPECT_EQ(first.descriptors(tile.tile_id, tile.level)->features.descriptors,
              second.descriptors(tile.tile_id, tile.level)->features.descriptors);
  }
}

TEST_F(ChunkedMap, SaysWhatIsMissing) {
  std::filesystem::rename(list_, folder_ / "elsewhere");
  EXPECT_THAT([&] { read_signed_map(path_, {key_}); },
              ThrowsMessage<DataError>(HasSubstr("map.gpkg.chunks: does not exist, and the signature names it")));
  write_file(list_, "PilotageChunks1\n", false);
  EXPECT_THAT([&] { read_signed_map(path_, {key_}); },
              ThrowsMessage<IntegrityError>(HasSubstr("is not the list of chunks that was signed")));
  std::filesystem::rename(folder_ / "elsewhere", list_);
  std::filesystem::remove(path_);
  EXPECT_THROW(read_signed_map(path_, {key_}), DataError);
  std::filesystem::create_directory(path_);
  EXPECT_THROW(read_signed_map(path_, {key_}), DataError);
}

TEST_F(ChunkedMap, RefusesAListThatIsNone) {
  const std::string list = read_file(list_);
  const std::string header = list.substr(0, kChunkListHeaderBytes);
  EXPECT_EQ(ChunkedFile(path_, "list", list).size(), content_.size());
  for (const std::string& wrong : {std::string(), header, list + "x", list + std::string(kChunkDigestBytes, 'x'),
                                   list.substr(0, list.size() - kChunkDigestBytes), "p" + list.substr(1),
                                   header.substr(0, 16) + std::string(8, '\xff') + list.substr(24)}) {
    EXPECT_THROW(ChunkedFile(path_, "list", wrong), DataError);
  }
}

TEST_F(ChunkedMap, AnEmptyFileIsNoMap) {
  write_file(path_, "", true);
  sign(0);
  std::string empty_list(kChunkListMagic);
  EXPECT_EQ(ChunkedFile(path_, "list", empty_list + std::string(8, '\0')).size(), 0U);
  EXPECT_THROW(MapReader::open(path_, {key_}), DataError);
}

}  // namespace
}  // namespace pilotage
