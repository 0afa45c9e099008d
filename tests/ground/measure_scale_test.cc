#include "pilotage/ground/measure_scale.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace pilotage {
namespace {

std::vector<TileScores> scores_with_variance(const std::vector<double>& values) {
  std::vector<TileScores> scores;
  for (const double value : values) {
    TileScores score;
    score.gray_variance = value;
    scores.push_back(score);
  }
  return scores;
}

const Measure& measure_named(std::string_view name) {
  for (const Measure* measure : heat_maps()) {
    if (measure->name == name) return *measure;
  }
  throw std::out_of_range("no such measure");
}

// Rec. 709 luminance of sRGB, IEC 61966-2-1.
double luminance(Rgb color) {
  const auto linear = [](double value) {
    value /= 255;
    return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
  };
  return 0.2126 * linear(color.red) + 0.7152 * linear(color.green) + 0.0722 * linear(color.blue);
}

TEST(ColorTable, EndsAreAsSaid) {
  EXPECT_EQ(hex_color(color_table(ColorMap::kBlues).front()), "#f4f1ea");
  EXPECT_EQ(hex_color(color_table(ColorMap::kBlues).back()), "#003262");
  const Rgb low = color_table(ColorMap::kCividis).front();
  const Rgb high = color_table(ColorMap::kCividis).back();
  EXPECT_GT(low.blue, low.red);    // dark blue
  EXPECT_GT(high.red, high.blue);  // yellow
}

TEST(ColorTable, BrightnessChangesOneWaySoThatItReadsWithoutHue) {
  const auto cividis = color_table(ColorMap::kCividis);
  const auto blues = color_table(ColorMap::kBlues);
  for (std::size_t i = 16; i < cividis.size(); ++i) {
    EXPECT_GT(luminance(cividis[i]), luminance(cividis[i - 16])) << i;
    EXPECT_LT(luminance(blues[i]), luminance(blues[i - 16])) << i;
  }
}

// CIE L*a*b* of sRGB, D65.
std::array<double, 3> lab(Rgb color) {
  const auto linear = [](double value) {
    value /= 255;
    return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
  };
  const double r = linear(color.red);
  const double g = linear(color.green);
  const double b = linear(color.blue);
  const auto root = [](double t) { return t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116; };
  const double x = root((0.4124564 * r + 0.3575761 * g + 0.1804375 * b) / 0.95047);
  const double y = root(0.2126729 * r + 0.7151522 * g + 0.0721750 * b);
  const double z = root((0.0193339 * r + 0.1191920 * g + 0.9503041 * b) / 1.08883);
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

TEST(ColorTable, EqualStepsOfBluesLookAlike) {
  const auto blues = color_table(ColorMap::kBlues);
  std::vector<double> steps;
  for (std::size_t i = 0; i + 15 < blues.size(); i += 15) {
    const auto from = lab(blues[i]);
    const auto to = lab(blues[i + 15]);
    steps.push_back(std::hypot(from[0] - to[0], from[1] - to[1], from[2] - to[2]));
  }
  const auto [least, most] = std::minmax_element(steps.begin(), steps.end());
  EXPECT_LT(*most / *least, 1.2);  // was 1.63
}

TEST(MeasureScale, SpansTheSecondToTheNinetyEighthPercentile) {
  std::vector<double> values;
  for (int i = 1; i <= 100; ++i) values.push_back(i);
  values.push_back(std::numeric_limits<double>::quiet_NaN());
  const MeasureScale scale = measure_scale(measure_named("gray_variance"), scores_with_variance(values));
  EXPECT_EQ(scale.low, 2);
  EXPECT_EQ(scale.high, 98);
  EXPECT_EQ(scale.least, 1);
  EXPECT_EQ(scale.most, 100);
}

TEST(MeasureScale, OneValueOrNoneStillSpansSomething) {
  const MeasureScale one = measure_scale(measure_named("gray_variance"), scores_with_variance({12, 12}));
  EXPECT_LT(one.low, 12);
  EXPECT_GT(one.high, 12);
  const MeasureScale zero = measure_scale(measure_named("gray_variance"), scores_with_variance({0}));
  EXPECT_GT(zero.high, zero.low);
  const MeasureScale none = measure_scale(measure_named("gray_variance"), {});
  EXPECT_GT(none.high, none.low);
  EXPECT_TRUE(std::isnan(none.least));
}

TEST(MeasureScale, CoverageSpansZeroToOne) {
  std::vector<TileScores> scores(3);
  for (TileScores& score : scores) score.valid_fraction = 0.95;
  const MeasureScale scale = measure_scale(measure_named("valid_fraction"), scores);
  EXPECT_EQ(scale.low, 0);
  EXPECT_EQ(scale.high, 1);
}

std::vector<TileScores> scores_with_p(const std::vector<double>& values) {
  std::vector<TileScores> scores(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) scores[i].p_correct_fix = values[i];
  return scores;
}

// Over good ground 0 to 1 is one colour: what ranks it spans what it has, and never less than a tenth.
TEST(MeasureScale, ProbabilityRanksTheGround) {
  const Measure& p = measure_named("p_correct_fix");
  std::vector<double> values;
  for (int i = 0; i <= 100; ++i) values.push_back(0.7 + 0.002 * i);
  const MeasureScale scale = measure_scale(p, scores_with_p(values));
  EXPECT_DOUBLE_EQ(scale.low, 0.704);
  EXPECT_DOUBLE_EQ(scale.high, 0.896);
  for (const double alike : {0.005, 0.5, 0.995}) {
    const MeasureScale narrow = measure_scale(p, scores_with_p({alike, alike + 0.001}));
    EXPECT_NEAR(narrow.high - narrow.low, 0.1, 1e-12) << alike;
    EXPECT_GE(narrow.low, 0);
    EXPECT_LE(narrow.high, 1);
    EXPECT_LE(narrow.low, alike);
    EXPECT_GE(narrow.high, alike);
  }
  const MeasureScale none = measure_scale(p, {});
  EXPECT_EQ(none.low, 0);
  EXPECT_EQ(none.high, 1);
}

TEST(Shade, ClampsAndTellsNoValueFromLow) {
  MeasureScale scale;
  scale.low = 10;
  scale.high = 20;
  EXPECT_EQ(shade(scale, 5), 0);
  EXPECT_EQ(shade(scale, 10), 0);
  EXPECT_EQ(shade(scale, 15), 128);
  EXPECT_EQ(shade(scale, 20), 255);
  EXPECT_EQ(shade(scale, 99), 255);
  EXPECT_EQ(shade(scale, std::numeric_limits<double>::quiet_NaN()), -1);
}

TEST(HeatMaps, EveryOneHasUnitAndMeaning) {
  for (const Measure* measure : heat_maps()) {
    EXPECT_FALSE(measure->heat.unit.empty()) << measure->name;
    EXPECT_FALSE(measure->heat.meaning.empty()) << measure->name;
    EXPECT_NE(measure->get, nullptr) << measure->name;
  }
}

}  // namespace
}  // namespace pilotage
