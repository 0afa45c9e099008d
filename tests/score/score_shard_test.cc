#include "pilotage/score/score_shard.h"

#include <bit>
#include <cmath>
#include <functional>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/file_digest.h"
#include "pilotage/base/random.h"
#include "pilotage/ground/tile_table.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// Numbers of every kind in some columns; the others are NaN.
ScoreShard some_shard(std::size_t tiles) {
  Random random(seed_from_name("some shard"));
  ScoreShard shard{{{"program", "test"}, {"inputs", {"a.tif"}}}, {3, 16}, {}};
  const double special[] = {0.0,
                            -0.0,
                            std::numeric_limits<double>::denorm_min(),
                            -std::numeric_limits<double>::quiet_NaN(),
                            std::numeric_limits<double>::infinity(),
                            1.0 / 3};
  for (std::size_t i = 0; i < tiles; ++i) {
    TileRow row;
    row.tile.tile_id = static_cast<std::int64_t>(7 * i);
    row.tile.level = static_cast<int>(i % 2);
    row.tile.column = static_cast<std::int64_t>(i);
    row.tile.center = {random.uniform(-180, 180), random.uniform(-90, 90)};
    row.tile.bounds = {random.normal(), random.normal(), random.normal(), random.normal()};
    row.min_col_px = static_cast<std::int64_t>(64 * i);
    TileScores& score = row.score;
    score.status = static_cast<TileStatus>(i % 3);
    score.valid_fraction = random.uniform(0, 1);
    score.gray_variance = random.normal();
    score.degraded.margin = special[i % 6];
    row.tile.valid_fraction = score.valid_fraction;
    shard.rows.push_back(row);
  }
  return shard;
}

/// NaN has no bits of its own in a table.
std::uint64_t bits(double number) {
  return std::isnan(number) ? ~std::uint64_t{0} : std::bit_cast<std::uint64_t>(number);
}

/// The bytes with a right digest behind whatever was changed.
std::string sealed(const std::string& changed) {
  const std::string content = changed.substr(0, changed.size() - 64);
  return content + bytes_digest(content);
}

std::string with_header(const std::function<void(nlohmann::ordered_json&)>& change) {
  const std::string bytes = score_shard_to_bytes(some_shard(5));
  const std::size_t begin = bytes.find('\n') + 1;
  const std::size_t end = bytes.find('\n', begin);
  nlohmann::ordered_json header = nlohmann::ordered_json::parse(bytes.substr(begin, end - begin));
  change(header);
  return sealed(bytes.substr(0, begin) + header.dump() + bytes.substr(end));
}

TEST(ScoreShard, ComesBackBitForBit) {
  const ScoreShard shard = some_shard(50);
  const ScoreShard again = score_shard_from_bytes("test", score_shard_to_bytes(shard));
  EXPECT_EQ(again.run, shard.run);
  EXPECT_EQ(again.shard, shard.shard);
  ASSERT_EQ(again.rows.size(), shard.rows.size());
  EXPECT_EQ(tile_table_to_csv(again.rows), tile_table_to_csv(shard.rows));
  for (std::size_t i = 0; i < shard.rows.size(); ++i) {
    const TileRow& row = again.rows[i];
    const TileRow& wanted = shard.rows[i];
    EXPECT_EQ(row.tile.tile_id, wanted.tile.tile_id);
    EXPECT_EQ(row.tile.level, wanted.tile.level);
    EXPECT_EQ(row.tile.cell(), wanted.tile.cell());
    EXPECT_EQ(bits(row.tile.center.lon_deg), bits(wanted.tile.center.lon_deg));
    EXPECT_EQ(bits(row.tile.bounds.min_x_m), bits(wanted.tile.bounds.min_x_m));
    EXPECT_EQ(row.min_col_px, wanted.min_col_px);
    EXPECT_EQ(row.score.status, wanted.score.status);
    EXPECT_EQ(bits(row.score.valid_fraction), bits(wanted.score.valid_fraction));
    for (const Measure& measure : measures()) {
      EXPECT_EQ(bits(measure.get(row.score)), bits(measure.get(wanted.score))) << measure.name;
    }
  }
}

TEST(ScoreShard, BoundsOfARasterInDegreesAreEmptyAndComeBack) {
  ScoreShard shard = some_shard(3);
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  for (TileRow& row : shard.rows) row.tile.bounds = {kNaN, kNaN, kNaN, kNaN};
  const std::string bytes = score_shard_to_bytes(shard);
  EXPECT_THAT(bytes, HasSubstr(",,,,,0,0,"));
  const ScoreShard again = score_shard_from_bytes("test", bytes);
  ASSERT_EQ(again.rows.size(), 3U);
  for (const TileRow& row : again.rows) {
    EXPECT_TRUE(std::isnan(row.tile.bounds.min_x_m) && std::isnan(row.tile.bounds.min_y_m) &&
                std::isnan(row.tile.bounds.max_x_m) && std::isnan(row.tile.bounds.max_y_m));
  }
  EXPECT_EQ(score_shard_to_bytes(again), bytes);
}

TEST(ScoreShard, EveryNumberOfATileScoreIsAColumn) {
  // What is measured but no column would get lost between shard and merge.
  ScoreShard shard = some_shard(1);
  double next = 1;
  for (const Measure& measure : measures()) measure.set(shard.rows[0].score, next++);
  const TileScores again = score_shard_from_bytes("test", score_shard_to_bytes(shard)).rows[0].score;
  const auto surface = [](const SurfaceScores& scores) {
    return std::vector{scores.peak,        scores.rival,      scores.margin,        scores.rival_ratio,
                       scores.psr,         scores.rivals,     scores.half_width_px, scores.expected_error_px,
                       scores.rival_dx_px, scores.rival_dy_px};
  };
  EXPECT_EQ(surface(again.clean), surface(shard.rows[0].score.clean));
  EXPECT_EQ(surface(again.degraded), surface(shard.rows[0].score.degraded));
  // 10 + 10 of surfaces, 4 of the second date, 12 plain ones: all doubles of the struct but valid_fraction.
  EXPECT_EQ(measures().size(), 38U);
}

TEST(ScoreShard, RefusesEveryTruncation) {
  const std::string bytes = score_shard_to_bytes(some_shard(3));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_THROW(score_shard_from_bytes("test", std::string_view(bytes).substr(0, size)), DataError) << size;
  }
  EXPECT_THROW(score_shard_from_bytes("test", bytes + "x"), IntegrityError);
}

TEST(ScoreShard, RefusesEveryFlippedBit) {
  const std::string bytes = score_shard_to_bytes(some_shard(3));
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    for (int bit = 0; bit < 8; ++bit) {
      std::string flipped = bytes;
      flipped[i] = static_cast<char>(flipped[i] ^ (1 << bit));
      EXPECT_THROW(score_shard_from_bytes("test", flipped), DataError) << i;
    }
  }
}

TEST(ScoreShard, RefusesALaterVersion) {
  std::string bytes = score_shard_to_bytes(some_shard(3));
  bytes[bytes.find('\n') - 1] = '3';
  EXPECT_THAT([&] { score_shard_from_bytes("test", sealed(bytes)); },
              ThrowsMessage<DataError>(HasSubstr("test: is a shard of version \"3\"; this program reads version 2")));
}

TEST(ScoreShard, RefusesHeadersThatLieUnderARightDigest) {
  EXPECT_NO_THROW(score_shard_from_bytes("test", with_header([](auto&) {})));
  using Json = nlohmann::ordered_json;
  struct Lie {
    const char* message;
    std::function<void(Json&)> tell;
  };
  const Lie lies[] = {
      {"has 5 tiles, its header says 6", [](Json& header) { header["tiles"] = 6; }},
      {"has 5 tiles, its header says 0", [](Json& header) { header["tiles"] = 0; }},
      {"its header says 1152921504606846976", [](Json& header) { header["tiles"] = std::int64_t{1} << 60; }},
      {"outside", [](Json& header) { header["tiles"] = -1; }},
      {"outside", [](Json& header) { header["shard"] = 17; }},
      {"outside", [](Json& header) { header["shards"] = 0; }},
      {"an integer", [](Json& header) { header["shard"] = 3.5; }},
      {"missing", [](Json& header) { header.erase("run"); }},
      {"more", [](Json& header) { header["more"] = 1; }}};
  for (const Lie& lie : lies) {
    EXPECT_THAT([&] { score_shard_from_bytes("test", with_header(lie.tell)); },
                ThrowsMessage<DataError>(HasSubstr(lie.message)));
  }
}

TEST(ScoreShard, RefusesRowsThatLieUnderARightDigest) {
  const std::string bytes = score_shard_to_bytes(some_shard(3));
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = bytes;
    return sealed(text.replace(text.find(from), from.size(), to));
  };
  const auto refused = [](const std::string& text, const std::string& message) {
    EXPECT_THAT([&] { score_shard_from_bytes("test", text); }, ThrowsMessage<DataError>(HasSubstr(message)));
  };
  refused(changed("\n7,1,", "\n0,1,"), "tile_id 0 does not follow 0");
  refused(changed("\n7,1,", "\n7,-1,"), "level = \"-1\"");
  refused(changed(",too_little_ground,", ",wet,"), "status = \"wet\"");
  refused(changed(",gray_variance,", ",gray,"), "column \"gray_variance\" is missing");
  refused(changed(",clean_rival,", ",clean_peak,"), "column \"clean_peak\" is a duplicate");
  refused(sealed(bytes.substr(0, bytes.find('\n') + 1) + std::string(64, '0')), "test");
}

TEST(ScoreShard, NamesSortByNumber) {
  EXPECT_EQ(shard_file_name({3, 16}), "scores-03-of-16.shard");
  EXPECT_EQ(shard_file_name({16, 16}), "scores-16-of-16.shard");
  EXPECT_EQ(shard_file_name({1, 1000}), "scores-0001-of-1000.shard");
}

}  // namespace
}  // namespace pilotage
