#include "pilotage/camera/terrain_heights.h"

#include <cmath>
#include <vector>

#include "camera/smooth_ground.h"
#include "raster/raster_maker.h"
#include "testing/temporary_folder.h"
#include <Eigen/LU>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/random.h"
#include "pilotage/camera/render_frame.h"
#include "pilotage/raster/gdal_crs.h"

namespace pilotage {
namespace {

using Eigen::Vector2d;
using testing::smooth_ground_gray;

constexpr double kOver_m = 100;
const Camera kTerrainCamera{160, 120, 135, 136, 81.5, 58.25};

/// East and north per metre that a ray falls, from the flat projection: its point on ground `agl_m` below.
Vector2d per_drop(const View& view, const Vector2d& pixel) {
  return *ground_from_pixel(view, pixel) / view.agl_m;
}

/// Ground of half a metre a pixel, north up, the aircraft over its middle.
GroundPlace north_up_place(int size_px) {
  GroundPlace place;
  place.nadir_px = {size_px / 2.0, size_px / 2.0};
  place.pixel_from_enu_m << 2, 0, 0, -2;
  return place;
}

GraySource smooth_source(int size_px, const GroundPlace& place) {
  Raster raster{cv::Mat(size_px, size_px, CV_8UC1), cv::Mat(size_px, size_px, CV_8UC1, cv::Scalar(255)), {}};
  const Eigen::Matrix2d enu_from_pixel = place.pixel_from_enu_m.inverse();
  for (int row = 0; row < size_px; ++row) {
    for (int col = 0; col < size_px; ++col) {
      const Vector2d ground_m = enu_from_pixel * (Vector2d(col + 0.5, row + 0.5) - place.nadir_px);
      raster.pixels.at<std::uint8_t>(row, col) = cv::saturate_cast<std::uint8_t>(smooth_ground_gray(ground_m / 4));
    }
  }
  return gray_source_from(raster);
}

TEST(TerrainHeights, RaysMeetATiltedPlaneWhereTheClosedFormSays) {
  for (const Vector2d& slope : {Vector2d(0.2, -0.1), Vector2d(-0.5, 0.4), Vector2d(0, 0)}) {
    const auto plane = [&](const Vector2d& p) { return slope.dot(p); };
    for (const Attitude attitude : {Attitude{0, 0, 0}, Attitude{133, 12, -9}}) {
      const View view = *make_view(kTerrainCamera, attitude, kOver_m);
      const TerrainHeights terrain = sample_terrain(view, 5, plane);
      for (int row = 0; row <= 120; row += 8) {
        for (int col = 0; col <= 160; col += 8) {
          const Vector2d pixel(col, row);
          const Vector2d per = per_drop(view, pixel);
          const auto met = terrain_from_pixel(view, terrain, pixel);
          ASSERT_TRUE(met.has_value()) << slope.transpose() << " " << col << " " << row;
          // agl − drop = slope · drop · per
          EXPECT_LT((*met - kOver_m / (1 + slope.dot(per)) * per).norm(), 3e-3) << slope.transpose();
        }
      }
    }
  }
}

TEST(TerrainHeights, AStepHidesTheGroundBehindIt) {
  // A mesa 30 m high east of 20 m, whose edge rises over one spacing, below 3 m; the camera looks 30 degrees to the
  // east.
  const auto mesa = [](const Vector2d& p) { return p.x() > 20 ? 30.0 : 0.0; };
  Camera camera = kTerrainCamera;
  camera.mount.pitch_deg = 30;
  const View view = *make_view(camera, {90, 0, 0}, kOver_m);
  const TerrainHeights terrain = sample_terrain(view, 1, mesa);
  int on_top = 0;
  int before = 0;
  for (int row = 0; row <= 120; ++row) {
    const Vector2d pixel(80, row);
    const Vector2d per = per_drop(view, pixel);
    const auto met = terrain_from_pixel(view, terrain, pixel);
    ASSERT_TRUE(met.has_value());
    const double east_at_ground = kOver_m * per.x();
    const double east_at_top = (kOver_m - 30) * per.x();
    if (east_at_top > 23) {  // over the edge where it is as high as the mesa
      EXPECT_NEAR(met->x(), east_at_top, 2e-3);
      ++on_top;
    } else if (east_at_ground < 17) {
      EXPECT_NEAR(met->x(), east_at_ground, 2e-3);
      ++before;
    } else {
      EXPECT_GT(met->x(), 16);  // the cliff's face
      EXPECT_LT(met->x(), 24);
    }
  }
  EXPECT_GT(on_top, 30);
  EXPECT_GT(before, 5);
}

TEST(TerrainHeights, LowerGroundIsLookedForAsFarAsRaysGo) {
  // 300 m of valley around a narrow plateau: the footprint on the valley's floor is four times as wide.
  const auto valley = [](const Vector2d& p) { return p.norm() < 40 ? 0.0 : -300.0; };
  const View view = *make_view(kTerrainCamera, {0, 0, 0}, kOver_m);
  const TerrainHeights terrain = sample_terrain(view, 5, valley);
  const auto corner = terrain_from_pixel(view, terrain, {0, 0});
  ASSERT_TRUE(corner.has_value());
  EXPECT_LT((*corner - 400 * per_drop(view, {0, 0})).norm(), 0.01);
}

TEST(TerrainHeights, WhatIsNotKnownIsNotSeen) {
  const View view = *make_view(kTerrainCamera, {0, 0, 0}, kOver_m);
  const TerrainHeights half = sample_terrain(view, 5, [](const Vector2d& p) { return p.x() > 10 ? kNaN : 0.0; });
  EXPECT_TRUE(terrain_from_pixel(view, half, {20, 60}).has_value());
  EXPECT_FALSE(terrain_from_pixel(view, half, {140, 60}).has_value());
  const TerrainHeights none = sample_terrain(view, 5, [](const Vector2d&) { return kNaN; });
  EXPECT_FALSE(terrain_from_pixel(view, none, {80, 60}).has_value());
  EXPECT_TRUE(std::isnan(none.highest_m()));
  EXPECT_THROW(TerrainHeights({0, 0}, 1, 2, {0, 0}), UsageError);
  EXPECT_THROW(TerrainHeights({0, 0}, 0, 2, {0, 0, 0, 0}), UsageError);
}

TEST(RenderTerrain, ConstantHeightsGiveTheFlatFrame) {
  const GroundPlace place = north_up_place(800);
  const GraySource ground = smooth_source(800, place);
  const Attitude attitude{41, 4, -3};
  const View view = *make_view(kTerrainCamera, attitude, kOver_m);
  const RenderedFrame flat = render_frame(ground, place, kTerrainCamera, attitude, kOver_m);
  const RenderedFrame terrain = render_terrain_frame(ground, place, kTerrainCamera, attitude, kOver_m,
                                                     sample_terrain(view, 10, [](const Vector2d&) { return 0.0; }));
  EXPECT_EQ(terrain.valid_fraction, 1);
  cv::Mat difference;
  cv::absdiff(flat.gray, terrain.gray, difference);
  double most = 0;
  cv::minMaxLoc(difference, nullptr, &most);
  EXPECT_LE(most, 1);  // rounding
  EXPECT_LT(cv::countNonZero(difference), 20);
}

TEST(RenderTerrain, ATiltedPlaneShowsTheGroundOfTheClosedForm) {
  const GroundPlace place = north_up_place(1200);
  const GraySource ground = smooth_source(1200, place);
  const Attitude attitude{200, -6, 5};
  const Vector2d slope(0.3, 0.25);
  const View view = *make_view(kTerrainCamera, attitude, kOver_m);
  const RenderedFrame frame =
      render_terrain_frame(ground, place, kTerrainCamera, attitude, kOver_m,
                           sample_terrain(view, 10, [&](const Vector2d& p) { return slope.dot(p); }));
  ASSERT_EQ(frame.valid_fraction, 1);
  double sum2 = 0;
  double flat_sum2 = 0;
  for (int row = 0; row < frame.gray.rows; ++row) {
    for (int col = 0; col < frame.gray.cols; ++col) {
      const Vector2d per = per_drop(view, Vector2d(col + 0.5, row + 0.5));
      const double gray = frame.gray.at<std::uint8_t>(row, col);
      sum2 += std::pow(gray - smooth_ground_gray(kOver_m / (1 + slope.dot(per)) * per / 4), 2);
      flat_sum2 += std::pow(gray - smooth_ground_gray(kOver_m * per / 4), 2);
    }
  }
  EXPECT_LT(std::sqrt(sum2 / static_cast<double>(frame.gray.total())), 1.0);
  EXPECT_GT(std::sqrt(flat_sum2 / static_cast<double>(frame.gray.total())), 15);
}

TEST(TerrainHeights, AreThoseOfTheElevationModelAboveTheGroundBelow) {
  const testing::TemporaryFolder folder;
  testing::RasterSpec spec;
  spec.width = 100;
  spec.height = 100;
  spec.type = GDT_Float32;
  spec.place = GeoTransform::north_up(500000, 5'000'000, 10);
  spec.value = [](int, int col, int row) { return 200 + 2 * col - row; };  // 0.2 up to the east, 0.1 up to the north
  const Elevation elevation(testing::make_raster(folder / "dem.tif", spec));
  const CrsTransform utm(Crs::from_user_input("EPSG:32633"));
  const View view = *make_view(kTerrainCamera, {0, 0, 0}, kOver_m);
  const TerrainHeights terrain = terrain_under(view, *utm.geodetic_from_map({500500, 4'999'500}), elevation);
  EXPECT_NEAR(terrain.height_m({0, 0}), 0, 1e-3);
  EXPECT_NEAR(terrain.height_m({30, 0}), 6, 0.02);  // on the central meridian grid north is true north
  EXPECT_NEAR(terrain.height_m({0, -30}), -3, 0.02);
  const TerrainHeights outside = terrain_under(view, *utm.geodetic_from_map({400000, 4'999'500}), elevation);
  EXPECT_TRUE(std::isnan(outside.highest_m()));
}

}  // namespace
}  // namespace pilotage
