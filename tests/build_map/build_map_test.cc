#include "pilotage/build_map/build_map.h"

#include <cmath>
#include <set>
#include <utility>

#include "testing/error_of.h"
#include "testing/temporary_folder.h"
#include "tile/small_mission.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/output_file.h"
#include "pilotage/ground/ground_imagery.h"
#include "pilotage/mapdb/chip_codec.h"
#include "pilotage/mapdb/map_landmarks.h"
#include "pilotage/mapdb/map_reader.h"
#include "pilotage/mapdb/map_verify.h"
#include "pilotage/mission/landmark_file.h"
#include "pilotage/raster/gray_stretch.h"
#include "pilotage/select/select_tiles.h"
#include "pilotage/tile/plan_tiles.h"

namespace pilotage {
namespace {

std::vector<TileScores> good_scores(const Mission& mission) {
  std::vector<TileScores> scores;
  for (const GroundTile& tile : mission.ground.tiles) {
    TileScores score;
    score.valid_fraction = tile.valid_fraction;
    score.gray_variance = 10;
    score.degraded.margin = 0.5;
    scores.push_back(score);
  }
  return scores;
}

Selection every_tile(const Mission& mission, std::size_t step = 1) {
  Selection selection;
  for (std::size_t i = 0; i < mission.ground.tiles.size(); i += step)
    selection.tile_ids.push_back(mission.ground.tiles[i].tile_id);
  selection.legs.resize(mission.flight.route.legs.size());
  return selection;
}

using GroundPoint = std::pair<double, double>;  // of one level, in its pixels

// All stored key points; each must lie in the window of its tile, and no two at the same place.
std::set<GroundPoint> stored_points(const std::filesystem::path& map) {
  MapReader reader = MapReader::open_unverified(map);
  std::set<GroundPoint> points;
  for (const MapTile& tile : reader.tiles()) {
    const auto stored = reader.descriptors(tile.tile_id, tile.level);
    if (!stored) continue;
    for (const Feature& feature : stored->features.features) {
      EXPECT_GE(feature.x_px, 0);
      EXPECT_LE(feature.x_px, stored->window.width);
      EXPECT_GE(feature.y_px, 0);
      EXPECT_LE(feature.y_px, stored->window.height);
      const auto [it, fresh] =
          points.emplace(static_cast<double>(feature.x_px) + static_cast<double>(stored->window.col),
                         static_cast<double>(feature.y_px) + static_cast<double>(stored->window.row));
      EXPECT_TRUE(fresh) << "tile " << tile.tile_id << ": stored twice: " << it->first << ", " << it->second;
    }
  }
  return points;
}

bool on_selected_ground(const Mission& mission, const Selection& selection, const GroundPoint& point) {
  const TileMatrix& matrix = mission.ground.levels[0].matrix;
  for (const GroundTile& tile : mission.ground.tiles) {
    if (!std::binary_search(selection.tile_ids.begin(), selection.tile_ids.end(), tile.tile_id)) continue;
    const PixelWindow window = matrix.tile_window(tile.column, tile.row);
    const double x = point.first - static_cast<double>(window.col);
    const double y = point.second - static_cast<double>(window.row);
    if (x >= 0 && y >= 0 && x < window.width && y < window.height) return true;
  }
  return false;
}

class BuildMap : public ::testing::Test {
 protected:
  testing::TemporaryFolder folder_;
  Mission mission_ = plan_tiles(testing::make_small_mission(folder_.path(), testing::two_legs()));
  std::vector<TileScores> scores_ = good_scores(mission_);

  BuildStats build(const std::string& name, const Selection& selection, int threads = 1,
                   const BuildOptions& options = {}) {
    return build_map(folder_ / name, mission_, scores_, selection, {}, "test", options, false, threads);
  }

  // Chips of `factor` × `factor` pixels of the level.
  BuildOptions with_chips(int factor, int gray_bits = 8) const {
    BuildOptions options;
    options.chips = {true, factor * mission_.ground.levels[0].gsd_m, gray_bits};
    return options;
  }
};

TEST_F(BuildMap, StoresEveryDescriptorOnceAndVerifies) {
  const BuildStats stats = build("map.gpkg", every_tile(mission_));
  EXPECT_EQ(stats.tiles, static_cast<std::int64_t>(mission_.ground.tiles.size()));
  EXPECT_GT(stats.descriptors, 200);
  EXPECT_EQ(static_cast<std::int64_t>(stored_points(folder_ / "map.gpkg").size()), stats.descriptors);
  EXPECT_EQ(stats.bytes, static_cast<std::int64_t>(std::filesystem::file_size(folder_ / "map.gpkg")));
  const VerifyReport report = verify_map(folder_ / "map.gpkg");
  EXPECT_TRUE(report.ok());
  EXPECT_EQ(report.content_digest, stats.content_digest);
}

TEST_F(BuildMap, StoresLandmarksOfThePlannedGround) {
  MapDetector detector;
  detector.detector.class_name = "tank";
  detector.detector.gsd_m = 0.5;
  detector.detector.context = 1.3;
  detector.detector.shortest_m = detector.detector.longest_m = 20;
  detector.detector.filters = {std::vector<float>(detector.detector.window.filter_size(), 0.5F)};
  detector.p_detect = 0.9;
  detector.sigma_m = 0.3;
  const GeodeticPoint here = mission_.flight.samples.front().point;
  MapLandmarks landmarks{{detector}, {{0, 0, here, 20, kNaN, true, 0.1}, {1, 0, {here.lon_deg, 0}, 20, kNaN, true, 0}}};
  const auto build_with = [&](const MapLandmarks& given) {
    write_file(folder_ / "landmarks.json", json_text(map_landmarks_to_json(given), 0), true);
    BuildOptions options;
    options.landmarks = (folder_ / "landmarks.json").string();
    return build("landmarks.gpkg", every_tile(mission_), 1, options);
  };
  const BuildStats stats = build_with(landmarks);
  EXPECT_EQ(stats.landmarks, 1) << "the other is elsewhere";
  EXPECT_EQ(stats.detectors, 1);
  BuildOptions options;
  const double without = stored_size(options, mission_.ground).bytes_fixed;
  options.landmarks = (folder_ / "landmarks.json").string();
  EXPECT_GT(stored_size(options, mission_.ground).bytes_fixed - without, 4 * 3752);
  MapReader reader = MapReader::open_unverified(folder_ / "landmarks.gpkg");
  const auto read = reader.landmarks();
  EXPECT_EQ(read->landmarks[0].place.lon_deg, here.lon_deg);
  EXPECT_EQ(read->detectors[0].detector.filters, detector.detector.filters);
  EXPECT_TRUE(verify_map(folder_ / "landmarks.gpkg").ok());

  landmarks.landmarks.erase(landmarks.landmarks.begin());
  landmarks.landmarks.front().id = 0;
  std::filesystem::remove(folder_ / "landmarks.gpkg");
  EXPECT_THAT(testing::error_of<DataError>([&] { build_with(landmarks); }),
              ::testing::HasSubstr("none of its landmarks lies on the ground of a tile"));
  std::string text = json_text(map_landmarks_to_json(landmarks), 0);
  text.replace(text.find("0.9"), 3, "1.0");
  write_file(folder_ / "landmarks.json", text, true);
  EXPECT_THAT(testing::error_of<IntegrityError>([&] { read_map_landmarks(folder_ / "landmarks.json"); }),
              ::testing::HasSubstr("was changed after it was written"));
  write_file(folder_ / "landmarks.json", "{}", true);
  EXPECT_THAT(testing::error_of<DataError>([&] { read_map_landmarks(folder_ / "landmarks.json"); }),
              ::testing::HasSubstr("holds no map landmarks; `pilotage landmark-score --for-map` writes"));
}

// The stored cells of a part of the tiles cover the union of these tiles and nothing else, with the very points that
// the map of all tiles has there.
TEST_F(BuildMap, StoredCellsCoverTheUnionOfTheSelectedTiles) {
  build("all.gpkg", every_tile(mission_));
  const std::set<GroundPoint> all = stored_points(folder_ / "all.gpkg");
  for (const std::size_t step : {2u, 5u}) {
    const Selection part = every_tile(mission_, step);
    const std::string name = "part" + std::to_string(step) + ".gpkg";
    build(name, part);
    std::set<GroundPoint> expected;
    for (const GroundPoint& point : all) {
      if (on_selected_ground(mission_, part, point)) expected.insert(point);
    }
    EXPECT_LT(expected.size(), all.size());
    EXPECT_EQ(stored_points(folder_ / name), expected) << step;
  }
}

// Put together, the chips of any part of the tiles show each pixel whose centre lies in one of them once, and no other,
// as the mean of the imagery's pixels.
TEST_F(BuildMap, ChipsShowAllSelectedGroundOnce) {
  const GraySource imagery = stretch_to_8bit(open_gray(mission_.ground, mission_.ground.levels[0]));
  for (const int factor : {1, 2, 3, 5}) {
    for (const std::size_t step : {1u, 2u, 5u}) {
      const Selection part = every_tile(mission_, step);
      const std::string name = "chips" + std::to_string(factor) + std::to_string(step) + ".gpkg";
      const BuildStats stats = build(name, part, 2, with_chips(factor));
      EXPECT_GT(stats.chips, 0);
      EXPECT_LE(stats.chips, stats.tiles);
      std::set<GroundPoint> seen;  // first pixel of the level under each pixel of a chip
      std::int64_t bytes = 0;
      MapReader map = MapReader::open_unverified(folder_ / name);
      for (const MapTile& tile : map.tiles()) {
        const auto chip = map.chip(tile.tile_id, tile.level);
        if (!chip) continue;
        bytes += static_cast<std::int64_t>(chip->data.size());
        const ChipPicture picture = decode_chip(*chip, name);
        ASSERT_EQ(picture.factor, factor);
        for (int row = 0; row < picture.gray.rows; ++row) {
          for (int col = 0; col < picture.gray.cols; ++col) {
            if (picture.valid.at<std::uint8_t>(row, col) == 0) continue;
            const PixelWindow square{chip->window.col + col * factor, chip->window.row + row * factor, factor, factor};
            EXPECT_TRUE(seen.emplace(square.col, square.row).second) << "stored twice";
            if (square.col + factor > imagery.width_px || square.row + factor > imagery.height_px) continue;
            EXPECT_NEAR(picture.gray.at<std::uint8_t>(row, col), cv::mean(imagery.read(square).pixels)[0], 0.51);
          }
        }
      }
      EXPECT_EQ(bytes, stats.chip_bytes);
      std::set<GroundPoint> expected;
      for (int y = 0; y < imagery.height_px; y += factor) {
        for (int x = 0; x < imagery.width_px; x += factor) {
          if (on_selected_ground(mission_, part, {x + 0.5 * factor, y + 0.5 * factor})) expected.emplace(x, y);
        }
      }
      EXPECT_EQ(seen, expected) << factor << " " << step;
      EXPECT_TRUE(verify_map(folder_ / name).ok());
    }
  }
}

TEST_F(BuildMap, WithoutChipsTheMapIsTheSameAsEver) {
  BuildOptions options;
  options.chips.chip_gsd_m = 7;
  build("plain.gpkg", every_tile(mission_));
  const BuildStats stats = build("still_plain.gpkg", every_tile(mission_), 1, options);
  EXPECT_EQ(stats.chips, 0);
  EXPECT_FALSE(MapReader::open_unverified(folder_ / "plain.gpkg").has_chips());
  EXPECT_TRUE(read_file(folder_ / "plain.gpkg") == read_file(folder_ / "still_plain.gpkg"));
}

TEST_F(BuildMap, SameBytesForAnyNumberOfThreads) {
  build("one.gpkg", every_tile(mission_), 1, with_chips(2, 4));
  build("four.gpkg", every_tile(mission_), 4, with_chips(2, 4));
  EXPECT_TRUE(read_file(folder_ / "one.gpkg") == read_file(folder_ / "four.gpkg"));
}

TEST_F(BuildMap, EstimateOfTheBudgetIsAnUpperBound) {
  int number = 0;
  for (const BuildOptions& build_options : {BuildOptions(), with_chips(1, 8), with_chips(2, 4), with_chips(3, 1)}) {
    for (const std::int64_t budget : {std::int64_t{0}, std::int64_t{400'000}}) {
      SelectOptions options;
      if (budget > 0) options.budget = std::to_string(budget);
      const Selection selection = select_tiles(mission_, scores_, stored_size(build_options, mission_.ground), options);
      const BuildStats stats = build("budget" + std::to_string(number++) + ".gpkg", selection, 1, build_options);
      EXPECT_LE(stats.bytes, selection.estimated_bytes);
      if (budget > 0) {
        EXPECT_LE(selection.estimated_bytes, budget);
      }
    }
  }
}

TEST_F(BuildMap, RefusesWhatIsOfAnotherPlanAndWhatExists) {
  Selection selection = every_tile(mission_);
  selection.tile_ids.push_back(selection.tile_ids.back() + 1);
  EXPECT_THROW(build("map.gpkg", selection), DataError);
  selection = every_tile(mission_);
  scores_.pop_back();
  EXPECT_THROW(build("map.gpkg", selection), DataError);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "map.gpkg"));
  scores_ = good_scores(mission_);
  build("map.gpkg", selection);
  EXPECT_THROW(build("map.gpkg", selection), DataError);
}

}  // namespace
}  // namespace pilotage
