#include "pilotage/build_map/stable_features.h"

#include <algorithm>
#include <map>

#include "testing/temporary_folder.h"
#include "tile/small_mission.h"
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/build_map/build_map.h"
#include "pilotage/mapdb/map_reader.h"
#include "pilotage/mapdb/map_verify.h"
#include "pilotage/tile/plan_tiles.h"

namespace pilotage {
namespace {

constexpr int kMoved_m = 3;
constexpr int kChanged_m = 330;   // the second date shows other ground from here to the east,
constexpr int kNoGround_m = 480;  // and none from here on

FeatureSet features_with(const std::vector<float>& responses) {
  FeatureSet set;
  set.descriptor_bytes = 2;
  for (const float response : responses) {
    set.features.push_back({static_cast<float>(set.size()), 0, 0, response});
    set.descriptors.insert(set.descriptors.end(), 2, static_cast<std::uint8_t>(set.size()));
  }
  return set;
}

TEST(DropContradicted, DropsWhatIsGoneAndKeepsTheRestWithItsRows) {
  FeatureSet set = features_with({5, 9, 7, 8});
  std::vector<float> heights{10, 11, 12, 13};
  StableStats stats;
  drop_contradicted(set, heights,
                    {FeatureFate::kGone, FeatureFate::kSurvives, FeatureFate::kNotKnown, FeatureFate::kGone},
                    kLeastFeatures, stats);
  ASSERT_EQ(set.size(), 2U);
  EXPECT_EQ(set.features[0].response, 9);
  EXPECT_EQ(set.features[1].response, 7);
  EXPECT_EQ(set.descriptors, (std::vector<std::uint8_t>{2, 2, 3, 3}));
  EXPECT_EQ(heights, (std::vector<float>{11, 12}));
  EXPECT_EQ(stats.survived, 1);
  EXPECT_EQ(stats.not_known, 1);
  EXPECT_EQ(stats.dropped, 2);
  EXPECT_EQ(stats.refilled, 0);
  EXPECT_EQ(stats.tiles_refilled, 0);
}

TEST(DropContradicted, TheStrongestStayWhereTooFewAreLeft) {
  FeatureSet set = features_with({5, 9, 7, 9, 8});
  std::vector<float> no_heights;
  StableStats stats;
  drop_contradicted(set, no_heights, std::vector<FeatureFate>(5, FeatureFate::kGone), kLeastFeatures - 2, stats);
  ASSERT_EQ(set.size(), 2U);
  EXPECT_EQ(set.features[0].x_px, 1);
  EXPECT_EQ(set.features[1].x_px, 3);
  EXPECT_EQ(stats.refilled, 2);
  EXPECT_EQ(stats.tiles_refilled, 1);
  EXPECT_EQ(stats.dropped, 3);
  EXPECT_TRUE(no_heights.empty());
}

TEST(WindowCounts, CountEveryWindowThatHoldsThePlace) {
  for (const int stride_px : {7, 30, 45}) {  // overlapping, side by side, with gaps
    const TileMatrix matrix{0, GeoTransform::north_up(0, 0, 1), 200, 150, 30, stride_px};
    WindowCounts counts(matrix);
    std::map<std::pair<std::int64_t, std::int64_t>, std::int64_t> expected;
    for (int y = 0; y < 150; y += 4) {
      for (int x = 0; x < 200; x += 5) {
        counts.add(x + 0.5, y);
        for (std::int64_t row = 0; row < matrix.matrix_height(); ++row) {
          for (std::int64_t column = 0; column < matrix.matrix_width(); ++column) {
            const PixelWindow window = matrix.tile_window(column, row);
            const bool inside = x >= window.col && x < window.col + 30 && y >= window.row && y < window.row + 30;
            expected[{row, column}] += inside ? 1 : 0;
          }
        }
      }
    }
    for (const auto& [tile, count] : expected) EXPECT_EQ(counts.take(tile.second, tile.first), count) << stride_px;
    EXPECT_EQ(counts.take(0, 0), 0);
  }
}

using Point = std::pair<double, double>;  // metres east and south of the raster's corner

class StableFeatures : public ::testing::Test {
 protected:
  testing::TemporaryFolder folder_;
  Mission mission_ = plan_tiles(testing::make_small_mission(folder_.path(), testing::two_legs()));
  std::string second_ = make_second();

  // The blocks of the small mission, 3 m further east; other ones in the middle, nothing in the east.
  std::string make_second() {
    testing::RasterSpec spec;
    spec.width = kNoGround_m - kMoved_m;
    spec.height = 400;
    spec.place = GeoTransform::north_up(500000 + kMoved_m, 5'000'000, 1);
    const auto blocks = [](std::string_view seed) {
      Random random(seed_from_name(seed));
      std::vector<double> values(75 * 50);
      for (double& value : values) value = 20.0 + static_cast<double>(random.below(200));
      return values;
    };
    spec.value = [same = blocks("small mission"), other = blocks("other")](int, int col, int row) {
      const auto block = static_cast<std::size_t>(row / 8 * 75 + col / 8);
      return col < kChanged_m ? same[block] : other[block];
    };
    return testing::make_raster(folder_ / "second.tif", spec);
  }

  BuildStats build(const std::string& name, KeepFeatures keep, int threads = 1) {
    const std::vector<TileScores> scores(mission_.ground.tiles.size());
    Selection selection;
    selection.legs.resize(mission_.flight.route.legs.size());
    for (const GroundTile& tile : mission_.ground.tiles) selection.tile_ids.push_back(tile.tile_id);
    BuildOptions options;
    options.keep_features = keep;
    return build_map(folder_ / name, mission_, scores, selection, {}, "test", options, false, threads, {},
                     register_second_date(mission_.ground, {second_}, {}, threads));
  }

  std::vector<Point> stored(const std::string& name) {
    MapReader reader = MapReader::open_unverified(folder_ / name);
    const GeoTransform place = mission_.ground.levels[0].matrix.map_from_pixel;
    std::vector<Point> points;
    for (const MapTile& tile : reader.tiles()) {
      const auto row = reader.descriptors(tile.tile_id, tile.level);
      if (!row) continue;
      for (const Feature& feature : row->features.features) {
        const Eigen::Vector2d at = place.map_from_pixel(
            {static_cast<double>(feature.x_px + row->window.col), static_cast<double>(feature.y_px + row->window.row)});
        points.emplace_back(at.x() - 500000, 5'000'000 - at.y());
      }
    }
    std::sort(points.begin(), points.end());
    return points;
  }
};

std::ptrdiff_t between(const std::vector<Point>& points, double west_m, double east_m) {
  return std::count_if(points.begin(), points.end(),
                       [&](const Point& point) { return point.first > west_m && point.first < east_m; });
}

TEST_F(StableFeatures, DropsThoseOfTheChangedPartAndKeepsTheOthers) {
  const BuildStats all = build("all.gpkg", KeepFeatures::kAll);
  const BuildStats stats = build("stable.gpkg", KeepFeatures::kStable);
  EXPECT_FALSE(all.stable.has_value());
  ASSERT_TRUE(stats.stable.has_value());
  EXPECT_EQ(stats.descriptors, stats.stable->survived + stats.stable->not_known + stats.stable->refilled);
  EXPECT_EQ(stats.descriptors + stats.stable->dropped, all.descriptors);
  EXPECT_GT(stats.stable->dropped, 100);
  const std::vector<Point> before = stored("all.gpkg");
  const std::vector<Point> after = stored("stable.gpkg");
  EXPECT_EQ(static_cast<std::int64_t>(after.size()), stats.descriptors);
  EXPECT_TRUE(std::includes(before.begin(), before.end(), after.begin(), after.end())) << "no feature is a new one";
  const auto share = [&](double west_m, double east_m) {
    EXPECT_GT(between(before, west_m, east_m), 100);
    return static_cast<double>(between(after, west_m, east_m)) / static_cast<double>(between(before, west_m, east_m));
  };
  EXPECT_GT(share(60, kChanged_m - 40), 0.8);
  EXPECT_LT(share(kChanged_m + 20, kNoGround_m - 40), 0.2);
  EXPECT_EQ(share(kNoGround_m, 600), 1) << "where the second date shows nothing, all are kept";
  EXPECT_TRUE(verify_map(folder_ / "stable.gpkg").ok());
}

TEST_F(StableFeatures, TheMapSaysSo) {
  build("all.gpkg", KeepFeatures::kAll);
  const StableStats stable = build("stable.gpkg", KeepFeatures::kStable).stable.value();
  const MapReader reader = MapReader::open_unverified(folder_ / "stable.gpkg");
  EXPECT_EQ(reader.info().find("keep_features"), "stable");
  EXPECT_EQ(reader.info().find("keep_features.dropped"), std::to_string(stable.dropped));
  EXPECT_EQ(reader.info().find("keep_features.not_known"), std::to_string(stable.not_known));
  EXPECT_FALSE(MapReader::open_unverified(folder_ / "all.gpkg").info().find("keep_features").has_value());
}

TEST_F(StableFeatures, SameBytesForAnyNumberOfThreads) {
  build("one.gpkg", KeepFeatures::kStable, 1);
  build("three.gpkg", KeepFeatures::kStable, 3);
  EXPECT_TRUE(read_file(folder_ / "one.gpkg") == read_file(folder_ / "three.gpkg"));
}

TEST_F(StableFeatures, NeedsItsSecondDate) {
  BuildOptions options;
  options.keep_features = KeepFeatures::kStable;
  const std::vector<TileScores> scores(mission_.ground.tiles.size());
  EXPECT_THROW(build_map(folder_ / "map.gpkg", mission_, scores, {}, {}, "test", options, false), UsageError);
}

}  // namespace
}  // namespace pilotage
