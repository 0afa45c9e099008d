#include "pilotage/survey/square_kilometres.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "pilotage/base/nan.h"
#include "pilotage/base/random.h"
#include "pilotage/ground/ground_of_rasters.h"
#include "pilotage/raster/gdal_crs.h"
#include "pilotage/verdict/tile_class.h"

namespace pilotage {
namespace {

constexpr double kGsd_m = 0.7;

struct ScoredArea {
  Ground ground;
  std::vector<TileScores> scores;

  ScoreTable table() const { return {ground, scores}; }
};

// Tiles of 70 m, one every 35 m, over some 2.1 km by 1.7 km that begin at no whole kilometre.
Ground ground_from(double west_m, double north_m) {
  Ground ground;
  ground.crs = Crs::from_user_input("EPSG:32633");
  GridLevel level;
  level.gsd_m = kGsd_m;
  level.matrix = {0, GeoTransform::north_up(west_m, north_m, kGsd_m), 3050, 2470, 100, 50};
  ground.levels.push_back(level);
  cut_all_tiles(ground, 1);
  return ground;
}

// A third of the tiles is missing, the others are of every class and status.
ScoredArea random_area() {
  Random random(seed_from_name("square kilometres"));
  ScoredArea area;
  area.ground = ground_from(594037.3, 6152013.8);
  std::erase_if(area.ground.tiles, [&](const GroundTile&) { return random.below(3) == 0; });
  for (std::size_t i = 0; i < area.ground.tiles.size(); ++i) {
    TileScores tile;
    tile.valid_fraction = 1;
    const auto kind = random.below(20);
    if (kind == 0) tile.status = TileStatus::kTooLittleGround;
    if (kind == 1) tile.status = TileStatus::kFlat;
    if (kind >= 3) tile.p_correct_fix = static_cast<double>(random.below(1000)) / 1000;  // 2: nothing is known
    if (random.below(2) == 0) tile.reasons.push_back(ReasonCode::kWater);
    if (random.below(5) == 0) tile.reasons.push_back(ReasonCode::kRepeats);
    if (random.below(3) == 0) tile.reasons.push_back(ReasonCode::kFewFeatures);
    area.scores.push_back(tile);
  }
  return area;
}

double median_of(std::vector<double> values) {
  if (values.empty()) return kNaN;
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

TEST(SquareKilometres, CountAsBruteForceDoes) {
  const ScoredArea area = random_area();
  const std::vector<SquareKilometre> squares = square_kilometres(area.table());
  std::size_t found = 0;
  for (std::int64_t north_km = 6152; north_km >= 6149; --north_km) {  // the order that is promised
    for (std::int64_t east_km = 593; east_km <= 597; ++east_km) {
      ClassCounts counts;
      std::vector<double> probabilities;
      std::map<ReasonCode, std::int64_t> reasons;
      for (std::size_t i = 0; i < area.scores.size(); ++i) {
        const Bounds& bounds = area.ground.tiles[i].bounds;
        const double east_m = (bounds.min_x_m + bounds.max_x_m) / 2 - 1000.0 * static_cast<double>(east_km);
        const double north_m = (bounds.min_y_m + bounds.max_y_m) / 2 - 1000.0 * static_cast<double>(north_km);
        if (!(east_m >= 0 && east_m < 1000 && north_m >= 0 && north_m < 1000)) continue;
        const TileScores& tile = area.scores[i];
        const double p = tile.p_correct_fix;
        if (!std::isnan(p)) probabilities.push_back(p);
        const bool scored = tile.status == TileStatus::kScored;
        if (scored && p >= 0.5) {
          ++counts.go;
          continue;
        }
        if (scored && std::isnan(p)) {
          ++counts.not_known;
        } else if (scored && p >= 0.2) {
          ++counts.marginal;
        } else {
          ++counts.no_go;
        }
        if (scored) {
          for (const ReasonCode code : tile.reasons) ++reasons[code];
        } else {
          ++reasons[tile.status == TileStatus::kFlat ? ReasonCode::kFlat : ReasonCode::kTooLittleGround];
        }
      }
      if (counts.all() == 0) continue;
      ASSERT_LT(found, squares.size());
      const SquareKilometre& square = squares[found++];
      EXPECT_EQ(square.east_km, east_km);
      EXPECT_EQ(square.north_km, north_km);
      const AreaStatistics& statistics = square.statistics;
      EXPECT_EQ(statistics.tiles.go, counts.go);
      EXPECT_EQ(statistics.tiles.marginal, counts.marginal);
      EXPECT_EQ(statistics.tiles.no_go, counts.no_go);
      EXPECT_EQ(statistics.tiles.not_known, counts.not_known);
      EXPECT_NEAR(statistics.area_km2, static_cast<double>(counts.all()) * 0.035 * 0.035, 1e-12);
      EXPECT_DOUBLE_EQ(statistics.median_p_correct_fix, median_of(probabilities));
      EXPECT_EQ((std::map<ReasonCode, std::int64_t>(statistics.reasons.begin(), statistics.reasons.end())), reasons);
    }
  }
  EXPECT_EQ(found, squares.size());
  EXPECT_GE(found, 6U);
}

TEST(SquareKilometres, TogetherAreTheWholeArea) {
  const ScoredArea area = random_area();
  std::vector<const TileScores*> all;
  for (const TileScores& tile : area.scores) all.push_back(&tile);
  const AreaStatistics whole = area_statistics(all, cell_km2(area.ground.levels.front()));
  ClassCounts sum;
  double area_km2 = 0;
  for (const SquareKilometre& square : square_kilometres(area.table())) {
    sum.go += square.statistics.tiles.go;
    sum.marginal += square.statistics.tiles.marginal;
    sum.no_go += square.statistics.tiles.no_go;
    sum.not_known += square.statistics.tiles.not_known;
    area_km2 += square.statistics.area_km2;
  }
  EXPECT_EQ(sum.go, whole.tiles.go);
  EXPECT_EQ(sum.marginal, whole.tiles.marginal);
  EXPECT_EQ(sum.no_go, whole.tiles.no_go);
  EXPECT_EQ(sum.not_known, whole.tiles.not_known);
  EXPECT_NEAR(area_km2, whole.area_km2, 1e-9);
  EXPECT_DOUBLE_EQ(whole.share(whole.tiles.go) + whole.share(whole.tiles.marginal) + whole.share(whole.tiles.no_go) +
                       whole.share(whole.tiles.not_known),
                   1);
}

// The centre of the first tile lies on a corner of the kilometre grid: it is of the square to its right and above.
TEST(SquareKilometres, LeftAndLowerEdgesBelongToASquare) {
  ScoredArea area;
  area.ground = ground_from(594000 - 35, 6152000 + 35);
  area.ground.tiles.resize(1);
  area.scores.resize(1);
  const std::vector<SquareKilometre> squares = square_kilometres(area.table());
  ASSERT_EQ(squares.size(), 1U);
  EXPECT_EQ(squares.front().name(), "E594 N6152");
  const auto middle = CrsTransform(area.ground.crs).geodetic_from_map({594500, 6152500}).value();
  EXPECT_NEAR(squares.front().center.lon_deg, middle.lon_deg, 1e-12);
  EXPECT_NEAR(squares.front().center.lat_deg, middle.lat_deg, 1e-12);
}

TEST(SquareKilometres, CausesComeBeforeWhatFollowsFromThem) {
  std::vector<TileScores> tiles(3);
  for (TileScores& tile : tiles) tile.p_correct_fix = 0.1;
  tiles[0].reasons = {ReasonCode::kFewFeatures, ReasonCode::kWater};
  tiles[1].reasons = {ReasonCode::kFewFeatures};
  tiles[2].reasons = {ReasonCode::kFewFeatures};
  const AreaStatistics statistics = area_statistics({&tiles[0], &tiles[1], &tiles[2]}, 1);
  EXPECT_EQ(statistics.reasons, (ReasonCounts{{ReasonCode::kWater, 1}, {ReasonCode::kFewFeatures, 3}}));
}

TEST(SquareKilometres, FarthestFromGoGroundIsThatOfBruteForce) {
  Random random(seed_from_name("farthest from go ground"));
  ScoredArea area = random_area();
  for (TileScores& tile : area.scores) {
    tile.status = TileStatus::kScored;
    tile.p_correct_fix = random.below(300) == 0 ? 0.9 : 0.1;
  }
  double farthest_m = 0;
  for (std::size_t i = 0; i < area.scores.size(); ++i) {
    double nearest_m = std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j < area.scores.size(); ++j) {
      if (tile_class(area.scores[j]) != TileClass::kGo) continue;
      const Eigen::Vector2d way = area.ground.tiles[i].bounds.center_m() - area.ground.tiles[j].bounds.center_m();
      nearest_m = std::min(nearest_m, way.norm());
    }
    farthest_m = std::max(farthest_m, nearest_m);
  }
  ASSERT_GT(farthest_m, 100);
  EXPECT_NEAR(farthest_from_go_m(area.table()), farthest_m, 0.01);
  for (TileScores& tile : area.scores) tile.p_correct_fix = 0.9;
  EXPECT_EQ(farthest_from_go_m(area.table()), 0);
  for (TileScores& tile : area.scores) tile.p_correct_fix = 0.1;
  EXPECT_TRUE(std::isnan(farthest_from_go_m(area.table())));
}

}  // namespace
}  // namespace pilotage
