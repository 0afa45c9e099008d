#include "pilotage/ground/measures.h"

#include <cmath>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/ground/score_raster.h"
#include "pilotage/ground/tile_table.h"

namespace pilotage {
namespace {

std::vector<std::string> names_of(const std::vector<const Measure*>& list) {
  std::vector<std::string> names;
  for (const Measure* measure : list) names.push_back(measure->name);
  return names;
}

/// A tile in which every measure has a number of its own.
TileRow measured_row() {
  TileRow row;
  double value = 0.5;
  for (const Measure& measure : measures()) measure.set(row.score, value++);
  return row;
}

TEST(Measures, AreNamedOnceAndDescribed) {
  std::set<std::string> names{coverage_measure().name};
  for (const Measure& measure : measures()) {
    EXPECT_TRUE(names.insert(measure.name).second) << measure.name << " is a duplicate";
    EXPECT_THAT(measure.name, ::testing::MatchesRegex("[a-z][a-z0-9_]*"));
    EXPECT_FALSE(measure.label.empty()) << measure.name;
    if (measure.unit == "px" || measure.unit == "m") {
      EXPECT_TRUE(measure.name.ends_with("_" + measure.unit)) << measure.name;
    }
  }
}

TEST(Measures, EveryOneIsAColumnOfTheTableAndABandOfTheRaster) {
  const TileRow row = measured_row();
  const std::string csv = tile_table_to_csv(std::vector{row});
  Ground ground;
  ground.levels.emplace_back();
  TileMatrix& matrix = ground.levels[0].matrix;
  matrix.grid_width_px = matrix.grid_height_px = matrix.tile_size_px = matrix.stride_px = 64;
  ground.tiles = {row.tile};
  const std::vector<TileScores> scores{row.score};
  const ScoreRaster raster = score_raster(ScoreTable(ground, scores), 0);
  ASSERT_EQ(raster.bands.size(), measures().size() + 1);
  EXPECT_EQ(raster.bands[0].name, "valid_fraction");
  for (std::size_t i = 0; i < measures().size(); ++i) {
    const Measure& measure = measures()[i];
    EXPECT_THAT(csv.substr(0, csv.find('\n')), ::testing::HasSubstr("," + measure.name + ","));
    EXPECT_EQ(raster.bands[i + 1].name, measure.name);
    EXPECT_EQ(raster.bands[i + 1].unit, measure.unit);
    EXPECT_EQ(raster.bands[i + 1].values.at<double>(0, 0), measure.get(row.score)) << measure.name;
  }
}

TEST(Measures, HeatMapsBeginWithTheOneToJudgeBy) {
  EXPECT_THAT(
      names_of(heat_maps()),
      ::testing::ElementsAre("p_correct_fix", "degraded_peak_margin", "clean_peak_margin", "gray_variance",
                             "frieden_deficit", "frieden_entropy", "valid_fraction", "map_features", "vegetation_share",
                             "water_share", "relief_m", "epoch_margin", "epoch_survival", "epoch_disagreement_m"));
  std::set<int> orders;
  for (const Measure* measure : heat_maps()) EXPECT_TRUE(orders.insert(measure->heat.order).second) << measure->name;
}

TEST(Measures, GroupsHoldEveryMeasureOnce) {
  const std::vector<std::string> names = names_of(measures_by_group());
  EXPECT_EQ(names.size(), measures().size() + 1);
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size());
  EXPECT_THAT(std::vector<std::string>(names.begin(), names.begin() + 7),
              ::testing::ElementsAre("p_correct_fix", "valid_fraction", "gray_variance", "frieden_entropy",
                                     "frieden_deficit", "map_features", "vote_noise"));
  EXPECT_EQ(names.back(), "epoch_disagreement_m");
}

TEST(Measures, UnitsForPeopleNameWhatHasNone) {
  EXPECT_EQ(shown_unit(*find_measure("clean_peak")), "NCC");
  EXPECT_EQ(shown_unit(*find_measure("degraded_psr")), "σ");
  EXPECT_EQ(shown_unit(*find_measure("relief_m")), "m");
  EXPECT_EQ(shown_unit(*find_measure("p_correct_fix")), "");
  EXPECT_EQ(find_measure("p_correct_fix")->heat.unit, "1");
  EXPECT_EQ(find_measure("relief_m")->heat.title, "Relief");
  EXPECT_EQ(find_measure("water_share")->heat.title, "Open water") << "the label, as it has no title of its own";
}

}  // namespace
}  // namespace pilotage
