#include "pilotage/score/merge_shards.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/random.h"
#include "pilotage/ground/tile_table.h"
#include "pilotage/raster/gdal_write.h"
#include "pilotage/score/describe_run.h"
#include "pilotage/score/score_shard.h"

namespace pilotage {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::TemporaryFolder;
using ::testing::ThrowsMessage;

/// Ground of floats with a hole in it, as a GeoTIFF. Floats: the result then depends on samples of the whole raster,
/// which every shard must take alike.
std::string write_ground(const TemporaryFolder& folder, int rows, int cols) {
  Random random(seed_from_name("merge"));
  cv::Mat values(rows, cols, CV_32F);
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) {
      values.at<float>(row, col) = static_cast<float>(
          500 + 80 * std::sin(0.07 * row) * std::cos(0.05 * col + 0.02 * row) + 30 * random.normal());
    }
  }
  values(cv::Rect(cols / 2, rows / 3, cols / 4, rows / 2)).setTo(std::numeric_limits<float>::quiet_NaN());
  const std::string file = folder.path() / "ground.tif";
  write_score_raster(file, {{"gray", "", values}}, Crs::from_user_input("EPSG:32633"),
                     GeoTransform::north_up(500000, 5000000, 0.5), false);
  return file;
}

ScoreRunOptions options_of_test() {
  ScoreRunOptions options;
  options.grid.tile_size_px = 48;
  options.grid.stride_px = 4;
  options.grid.search_radius_px = 12;
  options.score.measures = {ScoreMeasure::kGrayVariance, ScoreMeasure::kUniqueness, ScoreMeasure::kDegraded,
                            ScoreMeasure::kGroundCover, ScoreMeasure::kCorrectFix};
  options.score.degraded_copies = 1;
  return options;
}

std::string write_shard(const TemporaryFolder& folder, const ScoreRun& run, const Shard& shard, int threads) {
  std::vector<std::int64_t> places;
  for (const ShardTile& tile : shard_tiles(run, shard)) places.push_back(tile.place);
  std::sort(places.begin(), places.end());
  const Ground part = part_of_ground(run, places, threads);
  std::vector<TileScores> scores = score_ground_tiles(part, run.options.score, nullptr, run.seed, threads);
  const ScoreShard result{describe_run(run, "test 1"), shard, tile_rows(part, std::move(scores))};
  const std::string file = folder.path() / shard_file_name(shard);
  write_file(file, score_shard_to_bytes(result), true);
  return file;
}

TEST(MergeShards, GivesTheTableOfTheWholeRun) {
  const TemporaryFolder folder;
  // 96 columns of tiles: both groups of columns, and shards that end inside a row.
  const std::string ground = write_ground(folder, 80, 430);
  const ScoreRun run = open_score_run({ground}, options_of_test(), 7);
  const Ground all = whole_ground(run);
  const std::string whole = tile_table_to_csv(all, score_ground(all, run.options.score, run.seed).scores);
  std::vector<std::string> files;
  for (const std::int64_t number : {4, 2, 1, 3, 5}) {
    files.push_back(write_shard(folder, run, {number, 5}, 1 + static_cast<int>(number % 2)));
  }
  MergedShards merged = read_shards(files, "test 1");
  EXPECT_TRUE(merged.missing.empty());
  const Ground again = whole_ground(merged.run);
  explain_scores(again, merged.scores);
  EXPECT_EQ(tile_table_to_csv(again, merged.scores), whole);
  EXPECT_THAT(whole, HasSubstr("too_little_ground"));

  EXPECT_THAT(read_shards({files[0], files[2]}, "test 1").missing, ElementsAre(2, 3, 5));
  EXPECT_THAT(
      [&] {
        read_shards({files[0], files[1], files[0]}, "test 1");
      },
      ThrowsMessage<DataError>(HasSubstr("is shard 4, and so is")));
  EXPECT_THAT([&] { read_shards(files, "test 2"); }, ThrowsMessage<DataError>(HasSubstr("program: \"test 1\"")));
  EXPECT_EQ(shard_files({folder.path().string()}).size(), 5U);
}

TEST(MergeShards, RefusesAShardWithOtherTiles) {
  const TemporaryFolder folder;
  ScoreRunOptions options = options_of_test();
  options.score.measures = {ScoreMeasure::kGrayVariance};
  const ScoreRun run = open_score_run({write_ground(folder, 60, 80)}, options, 7);
  const std::string file = write_shard(folder, run, {1, 2}, 1);
  ScoreShard shard = read_score_shard(file);
  shard.rows.back().tile.tile_id += 1;
  write_file(file, score_shard_to_bytes(shard), true);
  EXPECT_THAT([&] { read_shards({file}, "test 1"); }, ThrowsMessage<DataError>(HasSubstr("expected ")));
  shard.rows.pop_back();
  write_file(file, score_shard_to_bytes(shard), true);
  EXPECT_THAT([&] { read_shards({file}, "test 1"); }, ThrowsMessage<DataError>(HasSubstr("tiles, expected ")));
}

TEST(DescribeRun, SeesWhatTheResultDependsOn) {
  const TemporaryFolder folder;
  const std::string file = write_ground(folder, 60, 80);
  const ScoreRunOptions options = options_of_test();
  const auto described = [&](std::uint64_t seed, const ScoreRunOptions& with) {
    return describe_run(open_score_run({file}, with, seed), "test 1");
  };
  const nlohmann::ordered_json first = described(7, options);
  EXPECT_EQ(run_difference(first, described(7, options)), "");
  EXPECT_EQ(run_difference(first, nlohmann::ordered_json::parse(first.dump())), "");
  EXPECT_EQ(run_difference(first, described(8, options)), "seed: 7, not 8");
  ScoreRunOptions other = options;
  other.score.degradation.noise = 0.06;
  EXPECT_EQ(run_difference(first, described(7, other)), "options.degradation.noise: 0.05, not 0.06");
  other = options;
  other.grid.imagery.nodata = 3;
  EXPECT_EQ(run_difference(first, described(7, other)), "options.nodata: not there, 3.0 in the other");
  write_file(file, read_file(file) + " ", true);
  EXPECT_THAT(run_difference(first, described(7, options)), HasSubstr("files." + file + ".bytes: "));
}

TEST(DescribeRun, CanBeOpenedAgain) {
  const TemporaryFolder folder;
  const ScoreRun run = open_score_run({write_ground(folder, 60, 80)}, options_of_test(), 7);
  const nlohmann::ordered_json description = describe_run(run, "test 1");
  const ScoreRun again = open_described_run("test", description);
  EXPECT_EQ(describe_run(again, "test 1"), description);
  nlohmann::ordered_json changed = description;
  changed["options"]["stride_px"] = "far";
  EXPECT_THROW(open_described_run("test", changed), DataError);
  changed = description;
  changed.erase("inputs");
  EXPECT_THROW(open_described_run("test", changed), DataError);
}

}  // namespace
}  // namespace pilotage
