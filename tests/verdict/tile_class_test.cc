#include "pilotage/verdict/tile_class.h"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

namespace pilotage {
namespace {

TileScores with_p(double p) {
  TileScores score;
  score.p_correct_fix = p;
  score.degraded.margin = -1;  // P wins over it
  return score;
}

TEST(TileClass, PartsAtThePublishedProbabilities) {
  EXPECT_EQ(tile_class(with_p(0.5)), TileClass::kGo);
  EXPECT_EQ(tile_class(with_p(0.499)), TileClass::kMarginal);
  EXPECT_EQ(tile_class(with_p(0.2)), TileClass::kMarginal);
  EXPECT_EQ(tile_class(with_p(0.199)), TileClass::kNoGo);
}

TEST(TileClass, GoesByTheMarginWithoutAProbability) {
  TileScores score;
  EXPECT_EQ(tile_class(score), std::nullopt);
  score.degraded.margin = 0.05;
  EXPECT_EQ(tile_class(score), TileClass::kGo);
  score.degraded.margin = 0.01;
  EXPECT_EQ(tile_class(score), TileClass::kMarginal);
  score.degraded.margin = 0;
  EXPECT_EQ(tile_class(score), TileClass::kNoGo);
}

TEST(TileClass, WhatCannotBeScoredIsNoGo) {
  TileScores score = with_p(0.9);
  score.status = TileStatus::kFlat;
  EXPECT_EQ(tile_class(score), TileClass::kNoGo);
}

TEST(TileClass, ClassesHaveNamesAndColoursOfTheirOwn) {
  std::set<std::string> names;
  std::set<std::array<std::uint8_t, 3>> colors;
  for (const RasterClass& next : tile_classes()) {
    names.insert(next.name);
    colors.insert(next.rgb);
  }
  EXPECT_EQ(names, (std::set<std::string>{"go", "marginal", "no-go"}));
  EXPECT_EQ(colors.size(), 3u);
  EXPECT_EQ(tile_classes()[static_cast<std::size_t>(TileClass::kNoGo)].name, "no-go");
}

// Eyes trained on traffic lights read yellow as caution: what is good has the blue of good.
TEST(ColorTable, GoodIsTheBlueOfGood) {
  const auto blues = color_table(ColorMap::kBlues);
  EXPECT_EQ(blues[182], status_color(QualityStatus::kGood));
  for (std::size_t i = 64; i < blues.size(); ++i) EXPECT_GT(blues[i].blue, blues[i].red + 40) << i;
}

}  // namespace
}  // namespace pilotage
