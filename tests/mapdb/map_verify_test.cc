#include "pilotage/mapdb/map_verify.h"

#include "mapdb/small_map.h"
#include "testing/key_pair.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/mapdb/map_signing.h"
#include "pilotage/mapdb/sqlite.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;

class MapVerify : public ::testing::Test {
 protected:
  MapVerify() : map_(testing::make_small_map()), path_(folder_ / "map.gpkg") {
    map_.content_digest = testing::write_map(path_, map_);
  }

  /// The report on the map after some SQL.
  VerifyReport after(const std::string& sql) {
    const auto copy = folder_ / "copy.gpkg";
    std::filesystem::copy_file(path_, copy, std::filesystem::copy_options::overwrite_existing);
    Database::create(copy, "map").execute(sql);
    return verify_map(copy);
  }

  testing::TemporaryFolder folder_;
  testing::SmallMap map_;
  std::filesystem::path path_;
};

const MapProblem* find_problem(const VerifyReport& report, const std::string& text) {
  for (const MapProblem& problem : report.problems) {
    if (problem.message.find(text) != std::string::npos) return &problem;
  }
  return nullptr;
}

TEST_F(MapVerify, FindsNothingInAWholeMap) {
  const VerifyReport report = verify_map(path_);
  EXPECT_TRUE(report.ok()) << report.problems.front().message;
  EXPECT_EQ(report.tiles, 12);
  EXPECT_EQ(report.descriptor_rows, 12);
  EXPECT_EQ(report.descriptors, 60);
  EXPECT_EQ(report.chips, 12);
  EXPECT_EQ(report.content_digest, map_.content_digest);
  EXPECT_NO_THROW(require_intact(report));
}

// The root of an R-tree whose two cells name the root itself, below 40 levels: 2^40 visits for who walks it.
const char* const kTreeInCircles =
    "UPDATE pilotage_tile_centers_node SET data = CAST(x'00280002"
    "0000000000000001C334000043340000C2B4000042B40000"
    "0000000000000001C334000043340000C2B4000042B40000' || substr(data, 53) AS BLOB) WHERE nodeno = 1";

TEST_F(MapVerify, EndsOnATreeThatLeadsInCircles) {
  const VerifyReport report = after(kTreeInCircles);
  EXPECT_THROW(require_intact(report), IntegrityError) << "the digest is checked before the structure";
  const std::string limit = std::to_string(Database::kMinReadingCost + Database::kReadingCostPerByte * report.bytes);
  EXPECT_NE(find_problem(report, "takes more steps than a sound map of its size can need (" + limit + " for " +
                                     std::to_string(report.bytes) + " bytes): its pages or indices lead in circles"),
            nullptr);
}

TEST_F(MapVerify, HearsTheWishToStopWhileSqliteWorks) {
  int calls = 0;
  const auto copy = folder_ / "copy.gpkg";
  std::filesystem::copy_file(path_, copy);
  Database::create(copy, "map").execute(kTreeInCircles);
  const auto stop_late = [&](std::string_view what, std::int64_t, std::int64_t) {
    return !(what == "checking the file" && ++calls > 20);
  };
  EXPECT_THROW(verify_map(copy, stop_late), Interrupted);
  EXPECT_EQ(calls, 21);
}

TEST_F(MapVerify, BytesInMemoryAreCheckedLikeAFile) {
  const std::string key = testing::generate_key_pair(folder_ / "a.key", folder_ / "a.pub");
  sign_file(path_, folder_ / "a.key");
  const SignedMap map = read_signed_map(path_, {key});
  write_file(path_, "what came after the check", true);
  const VerifyReport report = verify_map(map);
  EXPECT_TRUE(report.ok());
  EXPECT_EQ(report.content_digest, map_.content_digest);
}

TEST_F(MapVerify, SaysThatAJournalLiesBesideTheMap) {
  for (const char* suffix : {"-journal", "-wal"}) {
    const auto journal = folder_ / ("map.gpkg" + std::string(suffix));
    write_file(journal, "", false);
    EXPECT_TRUE(verify_map(path_).ok()) << "an empty one changes nothing";
    write_file(journal, "pages", true);
    EXPECT_NE(find_problem(verify_map(path_), "map.gpkg" + std::string(suffix) + ": lies beside the map"), nullptr);
    std::filesystem::remove(journal);
  }
}

// What an unkeyed program could have computed digests for: the numbers themselves make no sense.
TEST_F(MapVerify, RefusesNumbersThatMakeNoSense) {
  EXPECT_NE(find_problem(after("UPDATE pilotage_levels SET gsd_m = 1e5"), "is not that of its transform"), nullptr);
  EXPECT_NE(find_problem(after("INSERT INTO map_info (key, value) VALUES ('features.features_per_mpx', '20000'), "
                               "('features.pattern', 'brief'), ('features.descriptor_bits', '512'), "
                               "('features.fast_threshold', '20'), ('features.min_fast_threshold', '5'), "
                               "('features.octaves', '1'), ('features.scale_factor', '1.5')"),
                         "map_info says features.descriptor_bits = 512"),
            nullptr);
}

TEST_F(MapVerify, OneFlippedByteInADescriptorIsAWrongDigest) {
  std::string bytes = read_file(path_);
  const auto& descriptors = map_.descriptors[7].features.descriptors;
  const std::size_t at = bytes.find(std::string(descriptors.begin(), descriptors.end()));
  ASSERT_NE(at, std::string::npos);
  bytes[at + 40] = static_cast<char>(bytes[at + 40] ^ 1);
  write_file(folder_ / "flipped.gpkg", bytes, false);
  const VerifyReport report = verify_map(folder_ / "flipped.gpkg");
  EXPECT_THROW(require_intact(report), IntegrityError);
  const MapProblem* problem = find_problem(report, "tile 7: level 1: the digest does not match");
  ASSERT_NE(problem, nullptr);
  EXPECT_EQ(problem->kind, MapProblem::Kind::kDigest);
  EXPECT_EQ(problem->table, "pilotage_descriptors");
  EXPECT_EQ(problem->tile_id, 7);
  EXPECT_NE(find_problem(report, "content_digest is "), nullptr);
}

struct Damage {
  const char* sql;
  const char* message;
};

TEST_F(MapVerify, NamesEveryKindOfDamage) {
  const std::string drop =
      "DROP TRIGGER rtree_tiles_geom_update1; DROP TRIGGER rtree_tiles_geom_update2;"
      "DROP TRIGGER rtree_tiles_geom_update3; DROP TRIGGER rtree_tiles_geom_update4;"
      "DROP TRIGGER rtree_tiles_geom_delete;";
  for (const Damage& damage : {
           Damage{"UPDATE map_info SET value = 'x' WHERE key = 'tool'", "content_digest is "},
           Damage{"DELETE FROM map_info WHERE key = 'content_digest'", "has no content_digest"},
           Damage{"DELETE FROM tiles WHERE tile_id = 4", "tile 4: there is no such tile"},
           Damage{"DELETE FROM tiles WHERE tile_id = 4", "rtree_tiles_geom: has 12 entries for 11 tiles"},
           Damage{"UPDATE tiles SET max_x_m = max_x_m + 1 WHERE tile_id = 5",
                  "tiles: tile 5: its geometry is not the outline of its bounds"},
           Damage{"UPDATE tiles SET level = 3 WHERE tile_id = 5", "tile 5: level 3 is not in pilotage_levels"},
           Damage{"UPDATE tiles SET center_lat_deg = 0 WHERE tile_id = 5",
                  "pilotage_tile_centers: tile 5: its entry is not where the tile is"},
           Damage{"DELETE FROM rtree_tiles_geom WHERE id = 2", "rtree_tiles_geom: tile 2: has no entry"},
           Damage{"UPDATE rtree_tiles_geom SET minx = 0 WHERE id = 2", "tile 2: its entry is not where the tile is"},
           Damage{"UPDATE pilotage_levels SET max_tile_radius_m = 1 WHERE level = 1",
                  "is larger than max_tile_radius_m"},
           Damage{"UPDATE pilotage_descriptors SET window_col_px = 64 WHERE tile_id = 0",
                  "tile 0: level 0: the digest does not match"},
           Damage{"UPDATE pilotage_descriptors SET digest = zeroblob(31) WHERE tile_id = 0",
                  "digest blob has 31 bytes"},
           Damage{"UPDATE pilotage_chips SET data = zeroblob(12) WHERE tile_id = 6",
                  "pilotage_chips: tile 6: level 1: the digest does not match"},
           Damage{"UPDATE legs SET geom = x'00' WHERE fid = 1", "legs: line 1: geometry blob"},
           Damage{"CREATE TABLE stranger (a); INSERT INTO stranger VALUES (1)", "declares stranger, which no map has"},
           Damage{"CREATE INDEX stranger ON tiles (level)", "declares stranger, which no map has"},
           Damage{"UPDATE gpkg_contents SET srs_id = 7 WHERE table_name = 'route'",
                  "refers to one that does not exist"},
       }) {
    const VerifyReport report = after(drop + damage.sql);
    EXPECT_NE(find_problem(report, damage.message), nullptr)
        << damage.sql << " gave " << (report.ok() ? "nothing" : report.problems.front().message);
    EXPECT_THROW(require_intact(report), DataError);
    for (const MapProblem& problem : report.problems) EXPECT_THAT(problem.message, HasSubstr("copy.gpkg: "));
  }
}

TEST_F(MapVerify, WithoutAFileThereIsNothingToReport) {
  EXPECT_THROW(verify_map(folder_ / "none.gpkg"), DataError);
}

TEST(RequireIntact, WrongDigestOutranksDamage) {
  VerifyReport report;
  report.problems = {{MapProblem::Kind::kDamaged, "tiles", 1, "damage"},
                     {MapProblem::Kind::kDigest, "tiles", 1, "digest"}};
  EXPECT_THROW(require_intact(report), IntegrityError);
  report.problems.pop_back();
  try {
    require_intact(report);
    FAIL();
  } catch (const IntegrityError&) {
    FAIL() << "damage is not a wrong digest";
  } catch (const DataError& error) {
    EXPECT_STREQ(error.what(), "damage");
  }
}

}  // namespace
}  // namespace pilotage
