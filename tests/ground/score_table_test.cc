#include "pilotage/ground/score_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// Two levels of 5 x 4 tiles; of each level the tiles of every second column.
Ground two_levels() {
  Ground ground;
  for (int number = 0; number < 2; ++number) {
    GridLevel level;
    level.matrix = {number, GeoTransform::north_up(0, 0, 1), 50, 40, 10, 10};
    ground.levels.push_back(level);
  }
  for (int number = 0; number < 2; ++number) {
    for (std::int64_t row = 0; row < 4; ++row) {
      for (std::int64_t column = 0; column < 5; column += 2) {
        GroundTile tile;
        tile.tile_id = tile_id_of(ground.levels, number, column, row);
        tile.level = number;
        tile.column = column;
        tile.row = row;
        ground.tiles.push_back(tile);
      }
    }
  }
  return ground;
}

std::vector<TileScores> numbered_scores(const Ground& ground) {
  std::vector<TileScores> scores(ground.tiles.size());
  for (std::size_t i = 0; i < scores.size(); ++i) scores[i].gray_variance = static_cast<double>(i);
  return scores;
}

TEST(ScoreTable, RefusesAWrongCount) {
  const Ground ground = two_levels();
  std::vector<TileScores> scores = numbered_scores(ground);
  EXPECT_NO_THROW(ScoreTable(ground, scores));
  scores.pop_back();
  EXPECT_THAT([&] { ScoreTable(ground, scores); }, ThrowsMessage<DataError>(HasSubstr("23 scores, 24 tiles")));
  scores.resize(25);
  EXPECT_THAT([&] { ScoreTable(ground, scores); }, ThrowsMessage<DataError>(HasSubstr("25 scores, 24 tiles")));
}

TEST(LevelScores, AreOfTheTilesOfTheirLevel) {
  const Ground ground = two_levels();
  const std::vector<TileScores> scores = numbered_scores(ground);
  const ScoreTable table(ground, scores);
  const LevelScores upper(table, 1);
  EXPECT_EQ(upper.matrix().level, 1);
  EXPECT_FALSE(upper.has(11));
  EXPECT_TRUE(upper.has(12));
  for (const int wrong : {-1, 2}) {
    EXPECT_THAT([&] { LevelScores(table, wrong); },
                ThrowsMessage<UsageError>(HasSubstr("level = " + std::to_string(wrong))));
  }
}

TEST(ScoresOf, AreInTheOrderOfTheTiles) {
  const Ground ground = two_levels();
  const std::vector<TileScores> again =
      scores_of(ground, tile_rows(ground, numbered_scores(ground)), "t.csv", "plan.json");
  ASSERT_EQ(again.size(), ground.tiles.size());
  for (std::size_t i = 0; i < again.size(); ++i) EXPECT_EQ(again[i].gray_variance, static_cast<double>(i));
}

TEST(ScoresOf, RefusesATableOfOtherTiles) {
  const Ground ground = two_levels();
  const std::vector<TileRow> rows = tile_rows(ground, numbered_scores(ground));
  const auto refused = [&](const std::vector<TileRow>& table) {
    EXPECT_THAT([&] { scores_of(ground, table, "t.csv", "plan.json"); },
                ThrowsMessage<DataError>(HasSubstr("t.csv: is of other tiles than plan.json")));
  };
  std::vector<TileRow> fewer = rows;
  fewer.erase(fewer.begin() + 5);
  refused(fewer);
  fewer = rows;
  fewer.pop_back();
  refused(fewer);
  std::vector<TileRow> more = rows;
  more.push_back(rows.back());
  refused(more);
  std::vector<TileRow> out_of_order = rows;
  std::swap(out_of_order[3], out_of_order[4]);
  refused(out_of_order);
  for (const auto& change : {+[](GroundTile& tile) { ++tile.tile_id; }, +[](GroundTile& tile) { --tile.level; },
                             +[](GroundTile& tile) { ++tile.column; }, +[](GroundTile& tile) { ++tile.row; }}) {
    std::vector<TileRow> other = rows;
    change(other[20].tile);
    refused(other);
  }
}

TEST(TileIndex, NamesATileThatIsNotThere) {
  const Ground ground = two_levels();
  EXPECT_EQ(tile_index(ground, ground.tiles[17].tile_id, "the selection"), 17U);
  EXPECT_THAT([&] { tile_index(ground, 1, "the selection"); }, ThrowsMessage<DataError>(HasSubstr("the selection")));
}

}  // namespace
}  // namespace pilotage
