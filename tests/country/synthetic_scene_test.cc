#include "country/synthetic_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

using Eigen::Vector2d;

const Scene& scene() {
  static const Scene kScene = make_scene({});
  return kScene;
}

/// Pixels of side `gsd_m` around a place, with its middle in the middle.
GeoTransform around(const Vector2d& local_m, double gsd_m, int size_px) {
  const Vector2d center = scene().map_from_local({std::round(local_m.x()), std::round(local_m.y())});
  return GeoTransform::north_up(center.x() - gsd_m * size_px / 2, center.y() + gsd_m * size_px / 2, gsd_m);
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

cv::Mat gray_of(const Raster& raster) {
  cv::Mat gray;
  cv::cvtColor(raster.pixels, gray, cv::COLOR_RGB2GRAY);
  cv::Mat result;
  gray.convertTo(result, CV_32F);
  return result;
}

double ncc(const cv::Mat& a, const cv::Mat& b) {
  const cv::Mat da = a - cv::mean(a)[0];
  const cv::Mat db = b - cv::mean(b)[0];
  return da.dot(db) / std::sqrt(da.dot(da) * db.dot(db));
}

/// Median over tiles of 64 m within `reach_m` of a place of the two dates' NCC, and of the first date's gray deviation.
struct TwoDates {
  double ncc = 0;
  double deviation = 0;
};

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

TwoDates compare_dates(const Vector2d& place_m) {
  constexpr int kTile = 128;
  constexpr int kSize = 4 * kTile;
  const GeoTransform view = around(place_m, 0.5, kSize);
  const cv::Mat first = gray_of(render_rgb8(scene(), SceneEpoch::kFirst, view, kSize, kSize));
  const cv::Mat second = gray_of(render_rgb8(scene(), SceneEpoch::kSecond, view, kSize, kSize));
  std::vector<double> correlations;
  std::vector<double> deviations;
  for (int row = 0; row < kSize; row += kTile) {
    for (int col = 0; col < kSize; col += kTile) {
      const cv::Rect tile(col, row, kTile, kTile);
      correlations.push_back(ncc(first(tile), second(tile)));
      cv::Scalar mean;
      cv::Scalar deviation;
      cv::meanStdDev(first(tile), mean, deviation);
      deviations.push_back(deviation[0]);
    }
  }
  return {median(correlations), median(deviations)};
}

TEST(SyntheticScene, TheSameOptionsGiveTheSameBytesForAnyThreadCount) {
  const GeoTransform view = around(scene().sites.town, 0.5, 200);
  const Raster one = render_rgb8(scene(), SceneEpoch::kFirst, view, 200, 170, 1);
  const Raster three = render_rgb8(scene(), SceneEpoch::kFirst, view, 200, 170, 3);
  const Raster again = render_rgb8(make_scene({}), SceneEpoch::kFirst, view, 200, 170, 2);
  EXPECT_TRUE(same(one.pixels, three.pixels));
  EXPECT_TRUE(same(one.pixels, again.pixels));
  EXPECT_EQ(cv::countNonZero(one.valid), 200 * 170);
}

TEST(SyntheticScene, AnotherSeedGivesAnotherWorld) {
  SceneOptions options;
  options.seed = 2;
  const GeoTransform view = around(scene().sites.town, 0.5, 128);
  const Raster first = render_rgb8(scene(), SceneEpoch::kFirst, view, 128, 128);
  const Raster other = render_rgb8(make_scene(options), SceneEpoch::kFirst, view, 128, 128);
  EXPECT_LT(ncc(gray_of(first), gray_of(other)), 0.2);
}

TEST(SyntheticScene, WindowsArePartsOfTheWhole) {
  Random random(seed_from_name("WindowsArePartsOfTheWhole"));
  for (int trial = 0; trial < 12; ++trial) {
    const double gsd_m = std::array{0.25, 0.5, 1.0, 4.0}[random.below(4)];
    const Vector2d place(random.uniform(100, 2900), random.uniform(100, 1900));
    const GeoTransform view = around(place, gsd_m, 96);
    const SceneEpoch epoch = trial % 2 == 0 ? SceneEpoch::kFirst : SceneEpoch::kSecond;
    const Raster whole = render_rgb8(scene(), epoch, view, 96, 64);
    const cv::Mat labels = land_cover(scene(), epoch, view, 96, 64);
    const int col = static_cast<int>(random.below(95));
    const int row = static_cast<int>(random.below(63));
    const Raster part = render_rgb8(scene(), epoch, view.shifted(col, row), 96 - col, 64 - row);
    const cv::Rect window(col, row, 96 - col, 64 - row);
    EXPECT_TRUE(same(whole.pixels(window), part.pixels)) << place.transpose() << " gsd " << gsd_m;
    EXPECT_TRUE(same(whole.valid(window), part.valid));
    EXPECT_TRUE(same(labels(window), land_cover(scene(), epoch, view.shifted(col, row), 96 - col, 64 - row)));
  }
}

TEST(SyntheticScene, ATurnedViewShowsTheSameGround) {
  // A quarter turn about a pixel corner maps pixel centres on pixel centres: only the order of coordinates changes.
  const GeoTransform view = around(scene().sites.town, 0.5, 128);
  const Vector2d corner = view.map_from_pixel({128, 0});
  const GeoTransform turned{corner.x(), 0, -0.5, corner.y(), -0.5, 0};  // columns run south, rows run west
  cv::Mat expected;
  cv::rotate(render_rgb8(scene(), SceneEpoch::kFirst, view, 128, 128).pixels, expected, cv::ROTATE_90_COUNTERCLOCKWISE);
  const cv::Mat seen = render_rgb8(scene(), SceneEpoch::kFirst, turned, 128, 128).pixels;
  EXPECT_LE(cv::norm(expected, seen, cv::NORM_INF), 1);
}

TEST(SyntheticScene, CoarsePixelsAreMeansOfFineOnes) {
  const GeoTransform fine_view = around(scene().sites.town, 0.5, 512);
  const GeoTransform coarse_view = around(scene().sites.town, 4, 64);
  cv::Mat means;
  cv::resize(gray_of(render_rgb8(scene(), SceneEpoch::kFirst, fine_view, 512, 512)), means, {64, 64}, 0, 0,
             cv::INTER_AREA);
  const cv::Mat coarse = gray_of(render_rgb8(scene(), SceneEpoch::kFirst, coarse_view, 64, 64));
  EXPECT_GT(ncc(means, coarse), 0.98);
  EXPECT_NEAR(cv::mean(means)[0], cv::mean(coarse)[0], 3);
}

TEST(SyntheticScene, EveryKindOfGroundHasItsShare) {
  const int width = 750;
  const int height = 500;
  const cv::Mat labels = land_cover(scene(), SceneEpoch::kFirst, whole_scene_grid(scene(), 4), width, height);
  std::array<double, kLandCoverCount> share{};
  for (int row = 0; row < height; ++row) {
    for (int col = 0; col < width; ++col) {
      const unsigned char label = labels.at<unsigned char>(row, col);
      ASSERT_LT(label, kLandCoverCount);
      share[label] += 1.0 / (width * height);
    }
  }
  const auto of = [&](LandCover cover) { return share[static_cast<std::size_t>(cover)]; };
  EXPECT_GT(of(LandCover::kField), 0.25);
  EXPECT_GT(of(LandCover::kForest), 0.12);
  EXPECT_GT(of(LandCover::kGrass), 0.08);
  EXPECT_GT(of(LandCover::kWater), 0.03);
  EXPECT_GT(of(LandCover::kOrchard), 0.02);
  EXPECT_GT(of(LandCover::kRoad), 0.01);
  EXPECT_GT(of(LandCover::kRoof), 0.005);
  EXPECT_GT(of(LandCover::kBare), 0.005);
  for (std::size_t i = 0; i < share.size(); ++i) EXPECT_GT(share[i], 0.0002) << kLandCoverNames[i];
}

TEST(SyntheticScene, SitesLieOnTheGroundTheyName) {
  const auto dominant = [](const Vector2d& place_m, LandCover cover) {
    const cv::Mat labels = land_cover(scene(), SceneEpoch::kFirst, around(place_m, 0.5, 64), 64, 64);
    return cv::countNonZero(labels == static_cast<int>(cover)) / (64.0 * 64.0);
  };
  EXPECT_EQ(dominant(scene().sites.lake, LandCover::kWater), 1);
  EXPECT_GT(dominant(scene().sites.forest, LandCover::kForest), 0.9);
  EXPECT_EQ(dominant(scene().sites.orchard, LandCover::kOrchard), 1);
  EXPECT_GT(dominant(scene().sites.fields, LandCover::kField), 0.9);
  const cv::Mat town = land_cover(scene(), SceneEpoch::kFirst, around(scene().sites.town, 1, 256), 256, 256);
  EXPECT_GT(cv::countNonZero(town == static_cast<int>(LandCover::kRoof)) / (256.0 * 256.0), 0.08);
}

TEST(SyntheticScene, WhatStaysBetweenTheDatesOrdersTheKindsOfGround) {
  const TwoDates town = compare_dates(scene().sites.town);
  const TwoDates forest = compare_dates(scene().sites.forest);
  const TwoDates water = compare_dates(scene().sites.lake);
  const TwoDates orchard = compare_dates(scene().sites.orchard);
  const TwoDates fields = compare_dates(scene().sites.fields);
  // For the table in docs/methods/synthetic-scene.md: --gtest_output=json:FILE shows these.
  const auto record = [](const std::string& name, const TwoDates& measured) {
    RecordProperty(name + "_ncc", format_fixed(measured.ncc, 2));
    RecordProperty(name + "_deviation", format_fixed(measured.deviation, 1));
  };
  record("town", town);
  record("forest", forest);
  record("water", water);
  record("orchard", orchard);
  record("fields", fields);
  EXPECT_GT(town.ncc, 0.45);
  EXPECT_GT(town.ncc, forest.ncc + 0.15);
  EXPECT_GT(forest.ncc, water.ncc + 0.05);
  EXPECT_LT(std::abs(water.ncc), 0.2);
  // And within one date: rough town and forest, smooth water.
  EXPECT_GT(town.deviation, 20);
  EXPECT_GT(forest.deviation, 10);
  EXPECT_LT(water.deviation, 4);
}

TEST(SyntheticScene, TheOrchardRepeatsWithItsPeriod) {
  // Seen along its rows at 0.25 m a pixel, trees follow each other every 16 columns and rows every 20 pixel rows.
  const Vector2d rows = orchard_rows(scene(), scene().sites.orchard);
  const Vector2d center = scene().map_from_local(scene().sites.orchard);
  constexpr double kGsd_m = 0.25;
  constexpr int kSize = 320;
  GeoTransform view{0, rows.x() * kGsd_m, rows.y() * kGsd_m, 0, rows.y() * kGsd_m, -rows.x() * kGsd_m};
  const Vector2d offset = center - view.map_from_pixel({kSize / 2.0, kSize / 2.0});
  view.origin_x = offset.x();
  view.origin_y = offset.y();
  const cv::Mat gray = gray_of(render_rgb8(scene(), SceneEpoch::kFirst, view, kSize, kSize));
  const auto correlation = [&](int dx, int dy) {
    const cv::Rect here(0, 0, kSize - dx, kSize - dy);
    return ncc(gray(here), gray(here + cv::Point(dx, dy)));
  };
  EXPECT_GT(correlation(16, 0), 0.5);
  EXPECT_GT(correlation(0, 20), 0.5);
  EXPECT_GT(correlation(64, 60), 0.4);
  // Between the peaks at 0, 16 and 32 columns nothing comes near.
  for (int shift = 5; shift < 12; ++shift) {
    EXPECT_GT(correlation(16, 0), correlation(shift, 0) + 0.15) << shift;
    EXPECT_GT(correlation(32, 0), correlation(shift + 16, 0) + 0.15) << shift;
  }
  EXPECT_LT(correlation(0, 10), 0.2);
  EXPECT_THROW(orchard_rows(scene(), scene().sites.lake), UsageError);
}

TEST(SyntheticScene, ReliefIsGentleAndWaterLevel) {
  const cv::Mat heights = elevation(scene(), whole_scene_grid(scene(), 5), 600, 400);
  double low = 0;
  double high = 0;
  cv::minMaxLoc(heights, &low, &high);
  EXPECT_GE(low, 0);
  EXPECT_LE(high, 80);
  EXPECT_GT(high - low, 35);
  for (int row = 1; row < heights.rows; ++row) {
    for (int col = 1; col < heights.cols; ++col) {
      ASSERT_LT(std::abs(heights.at<float>(row, col) - heights.at<float>(row, col - 1)), 5 * 0.6);
      ASSERT_LT(std::abs(heights.at<float>(row, col) - heights.at<float>(row - 1, col)), 5 * 0.6);
    }
  }
  const cv::Mat lake = elevation(scene(), around(scene().sites.lake, 2, 40), 40, 40);
  double lake_low = 0;
  double lake_high = 0;
  cv::minMaxLoc(lake, &lake_low, &lake_high);
  EXPECT_EQ(lake_low, lake_high);
}

TEST(SyntheticScene, OutsideTheSceneNothingIsValid) {
  const GeoTransform view = whole_scene_grid(scene(), 0.5).shifted(-20, -10);
  const Raster raster = render_rgb8(scene(), SceneEpoch::kSecond, view, 40, 30);
  const cv::Mat labels = land_cover(scene(), SceneEpoch::kSecond, view, 40, 30);
  const cv::Mat heights = elevation(scene(), view, 40, 30);
  for (int row = 0; row < 30; ++row) {
    for (int col = 0; col < 40; ++col) {
      const bool inside = col >= 20 && row >= 10;
      EXPECT_EQ(raster.valid.at<unsigned char>(row, col), inside ? 255 : 0);
      EXPECT_EQ(labels.at<unsigned char>(row, col) == 255, !inside);
      EXPECT_EQ(std::isnan(heights.at<float>(row, col)), !inside);
    }
  }
}

TEST(SyntheticScene, ShadowsAreDarkAndFallAwayFromTheSun) {
  // Ground north-west of a town's roofs is shaded on the June morning, north-east of them on the September afternoon.
  const int size = 400;
  const GeoTransform view = around(scene().sites.town, 0.5, size);
  const auto roof_neighbours = [&](SceneEpoch epoch, int dx, int dy) {
    const cv::Mat gray = gray_of(render_rgb8(scene(), epoch, view, size, size));
    const cv::Mat labels = land_cover(scene(), epoch, view, size, size);
    double sum = 0;
    int count = 0;
    for (int row = 8; row < size - 8; ++row) {
      for (int col = 8; col < size - 8; ++col) {
        const bool roof = labels.at<unsigned char>(row - dy, col - dx) == static_cast<int>(LandCover::kRoof);
        if (!roof || labels.at<unsigned char>(row, col) != static_cast<int>(LandCover::kGrass)) continue;
        sum += gray.at<float>(row, col);
        ++count;
      }
    }
    return sum / count;
  };
  EXPECT_LT(roof_neighbours(SceneEpoch::kFirst, -3, -3), 0.75 * roof_neighbours(SceneEpoch::kFirst, 3, 3));
  EXPECT_LT(roof_neighbours(SceneEpoch::kSecond, 2, -4), 0.75 * roof_neighbours(SceneEpoch::kSecond, -2, 4));
}

TEST(SyntheticScene, BadViewsAndOptionsAreRefused) {
  const GeoTransform view = around(scene().sites.town, 0.5, 8);
  EXPECT_THROW(render_rgb8(scene(), SceneEpoch::kFirst, view, 0, 8), UsageError);
  EXPECT_THROW(render_rgb8(scene(), SceneEpoch::kFirst, GeoTransform{0, 0, 0, 0, 0, 0}, 8, 8), UsageError);
  EXPECT_THROW(land_cover(scene(), SceneEpoch::kFirst, GeoTransform{std::nan(""), 1, 0, 0, 0, 1}, 8, 8), UsageError);
  SceneOptions options;
  options.width_m = 50;
  EXPECT_THROW(make_scene(options), UsageError);
}

TEST(SyntheticScene, OtherSeedsAndSizesGiveWholeWorlds) {
  Random random(seed_from_name("OtherSeedsAndSizesGiveWholeWorlds"));
  for (int trial = 0; trial < 6; ++trial) {
    SceneOptions options;
    options.seed = static_cast<std::int64_t>(random.below(1U << 30));
    options.width_m = std::round(random.uniform(2000, 5000));
    options.height_m = std::round(random.uniform(1500, 4000));
    options.center_lat_deg = random.uniform(-60, 60);
    const Scene world = make_scene(options);
    EXPECT_EQ(world.epsg, (options.center_lat_deg >= 0 ? 32600 : 32700) + 33);
    const int width = static_cast<int>(options.width_m / 10);
    const int height = static_cast<int>(options.height_m / 10);
    const cv::Mat labels = land_cover(world, SceneEpoch::kSecond, whole_scene_grid(world, 10), width, height);
    for (const LandCover cover : {LandCover::kField, LandCover::kForest, LandCover::kWater, LandCover::kRoad,
                                  LandCover::kRoof, LandCover::kOrchard}) {
      EXPECT_GT(cv::countNonZero(labels == static_cast<int>(cover)), 20)
          << options.seed << " " << static_cast<int>(cover);
    }
  }
}

}  // namespace
}  // namespace pilotage
