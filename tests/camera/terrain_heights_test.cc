#include "pilotage/camera/terrain_heights.h"

#include <cmath>
#include <optional>
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

/// The way down between which a ray first meets the ground, followed in all steps of half a spacing, and where it
/// leads.
struct PlainDescent {
  Vector2d per_drop;
  double high_m;
  double low_m;
};

std::optional<PlainDescent> plain_descent(const View& view, const TerrainHeights& terrain,
                                          const Eigen::Vector3d& ray_camera) {
  const Eigen::Vector3d ray = view.enu_from_camera * ray_camera;
  if (!(ray.z() < 0)) return std::nullopt;
  const Vector2d per_drop = ray.head<2>() / -ray.z();
  if (!(per_drop.norm() <= view.max_off_nadir_tan)) return std::nullopt;
  const auto above_m = [&](double drop_m) { return view.agl_m - drop_m - terrain.height_m(drop_m * per_drop); };
  const double first_m = std::max(0.0, view.agl_m - terrain.highest_m() - 1e-3);
  const double last_m = view.agl_m - terrain.lowest_m() + 1e-3;
  const double steps = std::max(1.0, std::ceil((last_m - first_m) * per_drop.norm() / (terrain.spacing_m() / 2)));
  if (!(above_m(first_m) >= 0)) return std::nullopt;
  double high_m = first_m;
  for (double step = 1; step <= steps; ++step) {
    const double low_m = first_m + (last_m - first_m) * step / steps;
    const double over = above_m(low_m);
    if (std::isnan(over)) return std::nullopt;
    if (!(over > 0)) {
      for (int part = 1; part < 100; ++part) {
        if (std::isnan(above_m(high_m + (low_m - high_m) * part / 100))) return std::nullopt;
      }
      return PlainDescent{per_drop, high_m, low_m};
    }
    high_m = low_m;
  }
  return std::nullopt;
}

TEST(TerrainHeights, RaysAreFollowedTogetherAsOneByOneAndStepByStep) {
  Random random(3);
  const std::vector<Eigen::Vector3d> rays = corner_rays(kTerrainCamera);
  for (const bool with_holes : {false, true}) {
    std::vector<double> heights_m;
    for (int i = 0; i < 128 * 128; ++i) {
      const bool hole = with_holes && random.uniform() < 0.02;
      heights_m.push_back(hole ? kNaN : 12 * random.normal() * (i % 7 == 0 ? 1 : 0.2));  // walls, and rough ground
    }
    const TerrainHeights terrain(Vector2d(-250, -250), 4, 128, heights_m);
    EXPECT_EQ(std::isinf(terrain.steepest()), with_holes);
    const View view = *make_view(kTerrainCamera, {70, 25, -6}, kOver_m);
    std::vector<Vector2d> ground_m(rays.size());
    terrain_from_rays(view, terrain, rays, ground_m);
    int met = 0;
    int lost = 0;
    for (std::size_t i = 0; i < rays.size(); i += 13) {
      Vector2d alone_m;
      terrain_from_rays(view, terrain, {&rays[i], 1}, {&alone_m, 1});
      const auto plain = plain_descent(view, terrain, rays[i]);
      if (!plain && !std::isnan(ground_m[i].x())) {
        EXPECT_FALSE(std::isnan(terrain.height_m(ground_m[i]))) << i << ": met before a hole between two steps";
        continue;
      }
      ASSERT_EQ(std::isnan(ground_m[i].x()), !plain) << i;
      ++(plain ? met : lost);
      if (!plain) continue;
      EXPECT_EQ(alone_m, ground_m[i]) << i;
      const double drop_m = ground_m[i].dot(plain->per_drop) / plain->per_drop.squaredNorm();
      EXPECT_GE(drop_m, plain->high_m - 1e-9) << i;
      EXPECT_LE(drop_m, plain->low_m + 1e-9) << i;
      EXPECT_NEAR(view.agl_m - drop_m, terrain.height_m(ground_m[i]), 1.001e-3) << i;
    }
    EXPECT_GT(met, 800);
    EXPECT_EQ(lost > 0, with_holes);
  }
}

TEST(TerrainHeights, ANodeThatIsNotKnownIsASlopeWithoutBound) {
  for (std::size_t unknown = 0; unknown < 4; ++unknown) {
    std::vector<double> heights_m = {0, 1, 2, 3};
    EXPECT_NEAR(TerrainHeights({0, 0}, 2, 2, heights_m).steepest(), std::hypot(0.5, 1), 1e-12);
    heights_m[unknown] = kNaN;
    EXPECT_TRUE(std::isinf(TerrainHeights({0, 0}, 2, 2, heights_m).steepest())) << unknown;
  }
}

TEST(TerrainHeights, ItsEdgesBelongToIt) {
  std::vector<double> heights_m(64 * 64);
  for (std::size_t i = 0; i < heights_m.size(); ++i) heights_m[i] = static_cast<double>(i % 64);
  for (double spacing_m = 0.125; spacing_m < 8; spacing_m += 0.125) {  // products without rounding
    const TerrainHeights terrain({0, 0}, spacing_m, 64, heights_m);
    EXPECT_NEAR(terrain.height_m({63 * spacing_m, 63 * spacing_m}), 63, 1e-9) << spacing_m;
    EXPECT_TRUE(std::isnan(terrain.height_m({63.001 * spacing_m, spacing_m})));
  }
}

}  // namespace
}  // namespace pilotage
