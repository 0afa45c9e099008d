#include "pilotage/ground/tile_table.h"

#include <cmath>

#include "testing/error_of.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"

namespace pilotage {
namespace {

/// Rows with awkward numbers in every cell, some of them not defined.
std::vector<TileRow> random_rows(int count) {
  Random random(seed_from_name("tile_table"));
  const auto number = [&] { return std::ldexp(random.uniform(-1, 1), static_cast<int>(random.below(80)) - 40); };
  std::vector<TileRow> rows;
  for (int i = 0; i < count; ++i) {
    TileRow row;
    row.tile.tile_id = 3 * i + (std::int64_t{1} << 40);
    row.tile.level = i % 3;
    row.tile.column = i * 7;
    row.tile.row = i / 2;
    row.tile.center = {number(), number()};
    row.tile.bounds = {number(), number(), number(), number()};
    row.min_col_px = i * 64;
    row.min_row_px = i * 32;
    row.tile.valid_fraction = row.score.valid_fraction = random.uniform();
    row.score.status = i % 5 == 0 ? TileStatus::kTooLittleGround : i % 5 == 1 ? TileStatus::kFlat : TileStatus::kScored;
    for (const Measure& measure : measures()) {
      if (random.below(4) != 0) measure.set(row.score, number());
    }
    for (const auto& entry : enum_names(ReasonCode{})) {
      if (i % 4 != 0 && random.below(5) == 0) row.score.reasons.push_back(entry.value);
    }
    rows.push_back(row);
  }
  return rows;
}

std::string tile_table_error(std::string_view csv) {
  return testing::error_of<DataError>([&] { tile_table_from_csv("t.csv", csv); });
}

TEST(TileTable, ColumnsAreThePromisedOnes) {
  const std::string csv = tile_table_to_csv(std::vector<TileRow>{});
  EXPECT_EQ(
      csv,
      "tile_id,level,column,row,center_lon_deg,center_lat_deg,min_x_m,min_y_m,max_x_m,max_y_m,min_col_px,min_row_px,"
      "valid_fraction,status,gray_variance,frieden_entropy,frieden_deficit,"
      "clean_peak,clean_rival,clean_peak_margin,clean_rival_ratio,clean_psr,clean_rivals,clean_half_width_px,"
      "clean_expected_error_px,clean_rival_dx_px,clean_rival_dy_px,"
      "degraded_peak,degraded_rival,degraded_peak_margin,degraded_rival_ratio,degraded_psr,degraded_rivals,"
      "degraded_half_width_px,degraded_expected_error_px,degraded_rival_dx_px,degraded_rival_dy_px,"
      "epoch_ncc,epoch_margin,epoch_survival,epoch_disagreement_m,"
      "vegetation_share,water_share,aperture,relief_m,map_features,vote_noise,fine_contrast,p_correct_fix,level_"
      "sigma,level_tiles,level_age_months,"
      "reasons\n");
  EXPECT_TRUE(tile_table_from_csv("t.csv", csv).empty());
}

TEST(TileTable, EveryColumnReadsWhatItWrites) {
  for (const Measure& measure : measures()) {
    TileScores score;
    EXPECT_TRUE(std::isnan(measure.get(score))) << measure.name;
    measure.set(score, 0.25);
    EXPECT_EQ(measure.get(score), 0.25) << measure.name;
    for (const Measure& other : measures()) {
      if (other.name != measure.name) {
        EXPECT_TRUE(std::isnan(other.get(score))) << measure.name << " wrote " << other.name;
      }
    }
    EXPECT_EQ(find_measure(measure.name), &measure);
    EXPECT_FALSE(measure.description.empty());
  }
  EXPECT_EQ(find_measure("entropy"), nullptr);
}

TEST(TileTable, RoundTripIsExact) {
  const std::vector<TileRow> rows = random_rows(60);
  const std::string csv = tile_table_to_csv(rows);
  const std::vector<TileRow> again = tile_table_from_csv("t.csv", csv);
  ASSERT_EQ(again.size(), rows.size());
  EXPECT_EQ(tile_table_to_csv(again), csv);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(again[i].tile.center.lon_deg, rows[i].tile.center.lon_deg);
    EXPECT_EQ(again[i].tile.bounds.max_y_m, rows[i].tile.bounds.max_y_m);
    EXPECT_EQ(again[i].score.status, rows[i].score.status);
    EXPECT_EQ(again[i].tile.tile_id, rows[i].tile.tile_id);
    EXPECT_EQ(again[i].tile.level, rows[i].tile.level);
    EXPECT_EQ(again[i].tile.cell(), rows[i].tile.cell());
    EXPECT_EQ(again[i].tile.valid_fraction, rows[i].score.valid_fraction);
    EXPECT_EQ(again[i].score.reasons, rows[i].score.reasons);
    for (const Measure& measure : measures()) {
      const double before = measure.get(rows[i].score);
      const double after = measure.get(again[i].score);
      EXPECT_TRUE(before == after || (std::isnan(before) && std::isnan(after))) << measure.name;
    }
  }
}

TEST(TileTable, UnknownColumnsAndForeignLineEndsAreRead) {
  std::string csv = tile_table_to_csv(random_rows(3));
  std::string wider;
  for (const char c : csv) wider += c == '\n' ? std::string(",note\r\n") : std::string(1, c);
  EXPECT_EQ(tile_table_to_csv(tile_table_from_csv("t.csv", wider)), csv);
  csv.pop_back();  // no newline at the end
  EXPECT_EQ(tile_table_from_csv("t.csv", csv).size(), 3U);
}

TEST(TileTable, RefusesDamagedTables) {
  const std::string csv = tile_table_to_csv(random_rows(3));
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string text = csv;
    return text.replace(text.find(from), from.size(), to);
  };
  EXPECT_EQ(tile_table_error(""), "t.csv: empty, expected a table of tiles");
  EXPECT_EQ(tile_table_error(replaced("frieden_entropy", "entropy")),
            "t.csv: line 1: column \"frieden_entropy\" is missing");
  EXPECT_EQ(tile_table_error(replaced("clean_rival,", "clean_peak,")),
            "t.csv: line 1: column \"clean_peak\" is a duplicate");
  EXPECT_EQ(tile_table_error(replaced("flat", "flit")), "t.csv: line 3: status = \"flit\" is not allowed");
  EXPECT_EQ(tile_table_error(replaced("1099511627776", "1099511627776x")),
            "t.csv: line 2: tile_id = \"1099511627776x\" is not allowed");
  EXPECT_THAT(tile_table_error(replaced("1099511627779", "1099511627776")),
              ::testing::HasSubstr("line 3: tile_id 1099511627776 does not follow 1099511627776"));
  EXPECT_THAT(tile_table_error(csv + "1,2\n"),
              ::testing::HasSubstr("line 5: 2 cells, expected " + std::to_string(15 + measures().size())));
  EXPECT_EQ(tile_table_error(csv + "\n"), "") << "an empty line is no row (base/csv.h)";
}

TEST(TileTable, ReasonsAreKnownWords) {
  std::vector<TileRow> rows = random_rows(1);
  rows[0].score.reasons = {ReasonCode::kRepeats, ReasonCode::kWater};
  const std::string csv = tile_table_to_csv(rows);
  ASSERT_THAT(csv, ::testing::HasSubstr(",repeats;water\n"));
  for (const char* bad : {"repeats;", ";water", "repeats;;water", "boring", "repeats water"}) {
    std::string text = csv;
    text.replace(text.find("repeats;water"), 13, bad);
    EXPECT_THAT(tile_table_error(text), ::testing::HasSubstr("reasons = ")) << bad;
  }
}

TEST(TileTable, NotANumberIsNoCell) {
  std::vector<TileRow> rows = random_rows(1);
  rows[0].score.gray_variance = 123.25;
  std::string csv = tile_table_to_csv(rows);
  for (const char* bad : {"nan", "1e", "0x10", " 1", "1,5"}) {
    std::string text = csv;
    text.replace(text.find("123.25"), 6, bad);
    EXPECT_NE(tile_table_error(text), "") << bad;
  }
}

/// No prefix of a table, and no table with one byte changed, may do worse than a DataError.
TEST(TileTable, SurvivesAnyBytes) {
  const std::string csv = tile_table_to_csv(random_rows(2));
  Random random(seed_from_name("SurvivesAnyBytes"));
  for (std::size_t size = 0; size < csv.size(); size += 3) tile_table_error(std::string_view(csv).substr(0, size));
  for (int trial = 0; trial < 500; ++trial) {
    std::string text = csv;
    text[random.below(text.size())] = static_cast<char>(random.below(256));
    tile_table_error(text);
  }
}

TEST(TileRows, JoinAGroundAndItsScores) {
  Ground ground;
  GridLevel level;
  level.matrix.level = 1;
  level.matrix.tile_size_px = 128;
  level.matrix.stride_px = 32;
  level.matrix.grid_width_px = level.matrix.grid_height_px = 1000;
  ground.levels = {level, level};
  for (const std::int64_t id : {4, 9}) {
    GroundTile tile;
    tile.tile_id = id;
    tile.level = 1;
    tile.column = id;
    tile.row = 2;
    ground.tiles.push_back(tile);
  }
  std::vector<TileScores> scores(2);
  scores[1].gray_variance = 12;
  const std::vector<TileRow> rows = tile_rows(ground, scores);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[1].tile.tile_id, 9);
  EXPECT_EQ(rows[1].min_col_px, 9 * 32);
  EXPECT_EQ(rows[1].min_row_px, 2 * 32);
  EXPECT_EQ(rows[1].score.gray_variance, 12);
  EXPECT_EQ(tile_table_to_csv(ground, scores), tile_table_to_csv(rows));
}

}  // namespace
}  // namespace pilotage
