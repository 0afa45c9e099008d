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
    TileScores score;
    score.tile_id = static_cast<std::int64_t>(7 * i);
    score.status = static_cast<TileStatus>(i % 3);
    score.valid_fraction = random.uniform(0, 1);
    score.gray_variance = random.normal();
    score.degraded.margin = special[i % 6];
    shard.scores.push_back(score);
  }
  return shard;
}

std::uint64_t bits(double number) {
  return std::bit_cast<std::uint64_t>(number);
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
  ASSERT_EQ(again.scores.size(), shard.scores.size());
  for (std::size_t i = 0; i < shard.scores.size(); ++i) {
    EXPECT_EQ(again.scores[i].tile_id, shard.scores[i].tile_id);
    EXPECT_EQ(again.scores[i].status, shard.scores[i].status);
    EXPECT_EQ(bits(again.scores[i].valid_fraction), bits(shard.scores[i].valid_fraction));
    for (const Measure& measure : measures()) {
      EXPECT_EQ(bits(measure.get(again.scores[i])), bits(measure.get(shard.scores[i]))) << measure.name;
    }
  }
}

TEST(ScoreShard, EveryNumberOfATileScoreIsAColumn) {
  // What is measured but no column would get lost between shard and merge.
  ScoreShard shard = some_shard(1);
  double next = 1;
  for (const Measure& measure : measures()) measure.set(shard.scores[0], next++);
  const TileScores again = score_shard_from_bytes("test", score_shard_to_bytes(shard)).scores[0];
  const auto surface = [](const SurfaceScores& scores) {
    return std::vector{scores.peak,        scores.rival,      scores.margin,        scores.rival_ratio,
                       scores.psr,         scores.rivals,     scores.half_width_px, scores.expected_error_px,
                       scores.rival_dx_px, scores.rival_dy_px};
  };
  EXPECT_EQ(surface(again.clean), surface(shard.scores[0].clean));
  EXPECT_EQ(surface(again.degraded), surface(shard.scores[0].degraded));
  // 10 + 10 of surfaces, 4 of the second date, 10 plain ones: all doubles of the struct but valid_fraction.
  EXPECT_EQ(measures().size(), 34U);
}

TEST(ScoreShard, LeavesOutWhatWasNotMeasured) {
  const std::string bytes = score_shard_to_bytes(some_shard(1000));
  EXPECT_THAT(bytes, HasSubstr("\"columns\":[\"gray_variance\",\"degraded_peak_margin\"]"));
  EXPECT_LT(bytes.size(), 1000 * (8 + 1 + 8 + 2 * 8) + 400U);
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
  bytes[bytes.find('\n') - 1] = '2';
  EXPECT_THAT([&] { score_shard_from_bytes("test", sealed(bytes)); },
              ThrowsMessage<DataError>(HasSubstr("test: is a shard of version \"2\"; this program reads version 1")));
}

TEST(ScoreShard, RefusesHeadersThatLieUnderARightDigest) {
  EXPECT_NO_THROW(score_shard_from_bytes("test", with_header([](auto&) {})));
  using Json = nlohmann::ordered_json;
  struct Lie {
    const char* message;
    std::function<void(Json&)> tell;
  };
  const Lie lies[] = {{"expected", [](Json& header) { header["tiles"] = 6; }},
                      {"expected", [](Json& header) { header["tiles"] = 0; }},
                      {"outside", [](Json& header) { header["tiles"] = std::int64_t{1} << 60; }},
                      {"outside", [](Json& header) { header["tiles"] = -1; }},
                      {"expected",
                       [](Json& header) {
                         header["columns"].push_back("psr"), header["columns"].erase(2);
                         header["columns"].erase(1);
                       }},
                      {"is not known, or stands twice", [](Json& header) { header["columns"][1] = "gray_variance"; }},
                      {"is not known, or stands twice", [](Json& header) { header["columns"][1] = "later"; }},
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

TEST(ScoreShard, RefusesTilesThatDoNotAscendAndUnknownStatus) {
  const std::string bytes = score_shard_to_bytes(some_shard(3));
  const std::size_t arrays = bytes.find('\n', bytes.find('\n') + 1) + 1;
  std::string changed = bytes;
  changed[arrays + 8] = 0;  // the second id: 7 becomes 0
  EXPECT_THAT([&] { score_shard_from_bytes("test", sealed(changed)); },
              ThrowsMessage<DataError>(HasSubstr("tile_id 0 does not follow 0")));
  changed = bytes;
  changed[arrays + 24] = 3;  // the first status
  EXPECT_THAT([&] { score_shard_from_bytes("test", sealed(changed)); },
              ThrowsMessage<DataError>(HasSubstr("status 3")));
}

TEST(ScoreShard, NamesSortByNumber) {
  EXPECT_EQ(shard_file_name({3, 16}), "scores-03-of-16.shard");
  EXPECT_EQ(shard_file_name({16, 16}), "scores-16-of-16.shard");
  EXPECT_EQ(shard_file_name({1, 1000}), "scores-0001-of-1000.shard");
}

}  // namespace
}  // namespace pilotage
