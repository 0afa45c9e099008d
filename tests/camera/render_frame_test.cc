#include "pilotage/camera/render_frame.h"

#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "camera/smooth_ground.h"
#include "testing/grid_convergence.h"
#include <Eigen/LU>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"
#include "pilotage/camera/ortho_rectify.h"
#include "pilotage/camera/projection.h"
#include "pilotage/raster/mission_crs.h"

namespace pilotage {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using testing::distorted;
using testing::smooth_ground_gray;

constexpr double kAgl_m = 100;
const Camera kRenderedCamera{320, 240, 270, 272, 163.5, 117.25};

/// A grid turned by `turn_deg` with pixels of `gsd_m`, the aircraft over its middle.
GroundPlace turned_place(int size_px, double gsd_m, double turn_deg) {
  const double turn = turn_deg * std::numbers::pi / 180;
  Matrix2d pixel_from_enu;
  pixel_from_enu << std::cos(turn), std::sin(turn), std::sin(turn), -std::cos(turn);
  return {{size_px / 2.0 + 0.3, size_px / 2.0 - 0.2}, pixel_from_enu / gsd_m};
}

template <class Gray>
GraySource make_ground(int size_px, const GroundPlace& place, Gray gray) {
  Raster raster{cv::Mat(size_px, size_px, CV_8UC1), cv::Mat(size_px, size_px, CV_8UC1, cv::Scalar(255)), {}};
  const Matrix2d enu_from_pixel = place.pixel_from_enu_m.inverse();
  for (int row = 0; row < size_px; ++row) {
    for (int col = 0; col < size_px; ++col) {
      const Vector2d ground_m = enu_from_pixel * (Vector2d(col + 0.5, row + 0.5) - place.nadir_px);
      raster.pixels.at<std::uint8_t>(row, col) = cv::saturate_cast<std::uint8_t>(gray(ground_m));
    }
  }
  return gray_source_from(raster);
}

TEST(RenderFrame, OrthoRectifyGivesTheGroundBack) {
  const std::vector<Camera> cameras{
      kRenderedCamera,
      distorted(kRenderedCamera, DistortionModel::kBrownConrady, {-0.2, 0.05, 0.002, -0.001, -0.01}),
      distorted(kRenderedCamera, DistortionModel::kFisheye, {0.02, -0.01, 0.003, 0, 0}),
  };
  const std::vector<Attitude> attitudes{{0, 0, 0}, {152, 1.5, -0.8}, {-70, 12, 8}};
  for (const double gsd_m : {0.2, 0.7}) {  // finer and coarser than the frame's 0.37 m
    const int size_px = static_cast<int>(300 / gsd_m);
    const GroundPlace place = turned_place(size_px, gsd_m, 17);
    const GraySource ground = make_ground(size_px, place, smooth_ground_gray);
    for (const Camera& camera : cameras) {
      for (const Attitude& attitude : attitudes) {
        SCOPED_TRACE(::testing::Message()
                     << gsd_m << " m " << static_cast<int>(camera.distortion_model) << " " << attitude.yaw_deg);
        const RenderedFrame frame = render_frame(ground, place, camera, attitude, kAgl_m);
        ASSERT_EQ(frame.valid_fraction, 1);
        const RectifiedFrame back = ortho_rectify(frame.gray, camera, attitude, kAgl_m, {.gsd_m = 0.4});
        ASSERT_EQ(back.status, RectifyStatus::kOk);
        double sum2 = 0;
        double sum_by_east = 0;
        double sum_by_north = 0;
        double east2 = 0;
        double north2 = 0;
        int count = 0;
        for (int row = 0; row < back.gray.rows; ++row) {
          for (int col = 0; col < back.gray.cols; ++col) {
            if (back.valid.at<std::uint8_t>(row, col) == 0) continue;
            const Vector2d p = back.ground_from_pixel({col + 0.5, row + 0.5});
            const double error = back.gray.at<std::uint8_t>(row, col) - smooth_ground_gray(p);
            const double by_east = smooth_ground_gray(p + Vector2d(0.5, 0)) - smooth_ground_gray(p - Vector2d(0.5, 0));
            const double by_north = smooth_ground_gray(p + Vector2d(0, 0.5)) - smooth_ground_gray(p - Vector2d(0, 0.5));
            sum2 += error * error;
            sum_by_east += error * by_east;
            sum_by_north += error * by_north;
            east2 += by_east * by_east;
            north2 += by_north * by_north;
            ++count;
          }
        }
        ASSERT_GT(count, 10000);
        EXPECT_LT(std::sqrt(sum2 / count), 3.0);         // of a deviation of 40: three interpolations and rounding
        EXPECT_LT(std::abs(sum_by_east / east2), 0.02);  // metres by which the ground seems moved
        EXPECT_LT(std::abs(sum_by_north / north2), 0.02);
      }
    }
  }
}

TEST(RenderFrame, ADotLandsWhereTheProjectionSays) {
  const Camera camera = distorted(kRenderedCamera, DistortionModel::kBrownConrady, {-0.2, 0.05, 0.002, -0.001, -0.01});
  const double gsd_m = 0.25;
  const GroundPlace place = turned_place(1000, gsd_m, -31);
  Random random(seed_from_name("ADotLandsWhereTheProjectionSays"));
  for (int i = 0; i < 20; ++i) {
    const Attitude attitude{random.uniform(0, 360), random.uniform(-8, 8), random.uniform(-8, 8)};
    const Vector2d dot_m(random.uniform(-25, 25), random.uniform(-25, 25));
    const GraySource ground = make_ground(
        1000, place, [&](const Vector2d& p) { return 40 + 200 * std::exp(-(p - dot_m).squaredNorm() / 0.5); });
    const RenderedFrame frame = render_frame(ground, place, camera, attitude, kAgl_m);
    Vector2d moment(0, 0);
    double weight = 0;
    for (int row = 0; row < frame.gray.rows; ++row) {
      for (int col = 0; col < frame.gray.cols; ++col) {
        const double light = frame.gray.at<std::uint8_t>(row, col) - 40.0;
        if (frame.valid.at<std::uint8_t>(row, col) == 0 || light < 1) continue;
        weight += light;
        moment += light * Vector2d(col + 0.5, row + 0.5);
      }
    }
    const auto expected = pixel_from_ground(*make_view(camera, attitude, kAgl_m), dot_m);
    ASSERT_TRUE(expected.has_value());
    ASSERT_GT(weight, 50);
    EXPECT_LT((moment / weight - *expected).norm(), 0.02) << attitude.yaw_deg;
  }
}

TEST(RenderFrame, FineGroundDoesNotAlias) {
  // Stripes three ground pixels wide, twelve ground pixels to a pixel of the frame: their mean remains.
  const GroundPlace place = turned_place(6000, 0.03, 5);
  const GraySource ground = make_ground(
      6000, place, [](const Vector2d& p) { return 128 + 100 * std::sin(p.x() * 2 * std::numbers::pi / 0.09); });
  const RenderedFrame frame = render_frame(ground, place, kRenderedCamera, {20, 3, -2}, kAgl_m);
  ASSERT_EQ(frame.valid_fraction, 1);
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(frame.gray, mean, deviation);
  EXPECT_NEAR(mean[0], 128, 0.5);
  EXPECT_LT(deviation[0], 8);  // the stripes themselves have 71
}

TEST(RenderFrame, ReadsOnlyUnderTheFootprintAndMarksWhatIsMissing) {
  const GroundPlace place = turned_place(2000, 0.4, 0);
  const GraySource whole = make_ground(2000, place, smooth_ground_gray);
  auto windows = std::make_shared<std::vector<PixelWindow>>();
  GraySource ground = whole;
  ground.read = [whole, windows](const PixelWindow& window) {
    windows->push_back(window);
    Raster raster = whole.read(window);
    raster.valid = raster.valid.clone();
    raster.valid.colRange(0, window.width / 2).setTo(0);
    return raster;
  };
  const Camera camera = kRenderedCamera;
  const RenderedFrame frame = render_frame(ground, place, camera, {}, kAgl_m);
  ASSERT_EQ(windows->size(), 1U);
  EXPECT_LT(windows->front().width, 320 / 270.0 * kAgl_m / 0.4 + 12);
  EXPECT_LT(windows->front().height, 240 / 272.0 * kAgl_m / 0.4 + 12);
  EXPECT_NEAR(frame.valid_fraction, 0.5, 0.02);
  EXPECT_EQ(cv::countNonZero(frame.valid.colRange(0, 150)), 0);
  EXPECT_EQ(cv::countNonZero(frame.gray.colRange(0, 150)), 0);
  EXPECT_EQ(cv::countNonZero(frame.valid.colRange(170, 320)), 150 * 240);
  EXPECT_TRUE(footprint_inside(ground, place, camera, {}, kAgl_m));

  GroundPlace edge = place;
  edge.nadir_px = {10, 1000};
  EXPECT_FALSE(footprint_inside(ground, edge, camera, {}, kAgl_m));
  EXPECT_FALSE(footprint_inside(ground, place, camera, {0, 80, 0}, kAgl_m));
  edge.nadir_px = {-5000, 1000};
  const RenderedFrame nothing = render_frame(ground, edge, camera, {}, kAgl_m);
  EXPECT_EQ(nothing.valid_fraction, 0);
  EXPECT_EQ(nothing.gray.size(), cv::Size(320, 240));
}

TEST(RenderFrame, RefusesWhatItCannotRender) {
  const GroundPlace place = turned_place(100, 1, 0);
  GraySource ground = make_ground(100, place, smooth_ground_gray);
  const Camera camera = kRenderedCamera;
  EXPECT_THROW(render_frame(ground, place, camera, {}, 0), UsageError);
  EXPECT_THROW(render_frame(ground, place, camera, {std::nan(""), 0, 0}, 100), UsageError);
  EXPECT_THROW(render_frame(ground, place, Camera{}, {}, 100), UsageError);
  ground.width_px = ground.height_px = 100000;
  const GroundPlace huge{{5e4, 5e4}, Matrix2d::Identity() * 300};
  EXPECT_THROW(render_frame(ground, huge, camera, {}, 100), UsageError);
  ground.depth = CV_16U;
  EXPECT_THROW(render_frame(ground, place, camera, {}, 100), UsageError);
}

TEST(GroundPlace, KnowsUnitScaleAndConvergence) {
  struct Case {
    const char* crs;
    GeoTransform grid;
    double gsd_x_m;
    double gsd_y_m;
  };
  // UTM 3 degrees off its meridian at 60 N; feet; the stretched metres of EPSG:3857 at 60 N (1 : 1/cos lat, on the
  // ellipsoid 0.1 % apart in both directions); degrees.
  const double lat = 60 * std::numbers::pi / 180;
  const double e2 = 0.00669437999014;
  const double w = std::sqrt(1 - e2 * std::sin(lat) * std::sin(lat));
  const double east_scale = std::cos(lat) / w;
  const double north_scale = std::cos(lat) * (1 - e2) / (w * w * w);
  const std::vector<Case> cases{
      {"EPSG:32633", GeoTransform::north_up(660000, 6657000, 0.5), 0, 0},
      {"EPSG:2994", GeoTransform::north_up(636000, 852000, 1), 0, 0},
      {"EPSG:3857", GeoTransform::north_up(1e6, 8399737.889 + 500 * 0.6, 0.6), 0.6 * east_scale, 0.6 * north_scale},
      {"EPSG:4326", GeoTransform::north_up(10, 60 + 500 * 1e-5, 1e-5),
       1e-5 * std::numbers::pi / 180 * 6378137 / w * std::cos(lat),
       1e-5 * std::numbers::pi / 180 * 6378137 * (1 - e2) / (w * w * w)},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.crs);
    const Crs crs = Crs::from_user_input(c.crs);
    const Vector2d nadir_px(500, 500);
    const GroundPlace place = ground_place(crs, c.grid, nadir_px);
    EXPECT_EQ(place.nadir_px, nadir_px);
    const Matrix2d enu_from_pixel = place.pixel_from_enu_m.inverse();
    EXPECT_LT(enu_from_pixel.determinant(), 0);  // rows run south
    if (c.gsd_x_m > 0) {
      EXPECT_NEAR(enu_from_pixel.col(0).norm() / c.gsd_x_m, 1, 1e-5);
      EXPECT_NEAR(enu_from_pixel.col(1).norm() / c.gsd_y_m, 1, 1e-5);
    }
    // Grid north seen from true north.
    const Vector2d up = -enu_from_pixel.col(1);
    const GeodeticPoint nadir = geodetic_from_pixel(CrsTransform(crs), c.grid, nadir_px);
    if (crs.is_projected()) {
      const double convergence_deg = std::atan2(up.x(), up.y()) * 180 / std::numbers::pi;
      EXPECT_NEAR(convergence_deg, testing::grid_convergence_deg(crs, nadir), 2e-4);
    }
    // 100 m by geodesic are 100 m by the Jacobian.
    const CrsTransform transform(crs);
    const auto pixel_of = [&](GeodeticPoint point) {
      return c.grid.pixel_from_map(*transform.map_from_geodetic(point));
    };
    const double step_deg = 1e-3;
    const Vector2d north_px = pixel_of({nadir.lon_deg, nadir.lat_deg + step_deg}) - nadir_px;
    const Vector2d north_m = enu_from_pixel * north_px;
    const double sin_lat = std::sin(nadir.lat_deg * std::numbers::pi / 180);
    const double meridian_radius = 6378137 * (1 - e2) / std::pow(1 - e2 * sin_lat * sin_lat, 1.5);
    EXPECT_NEAR(north_m.y(), step_deg * std::numbers::pi / 180 * meridian_radius, 0.02);
    EXPECT_NEAR(north_m.x(), 0, 0.01);
  }
}

}  // namespace
}  // namespace pilotage
