#include <cmath>

#include "raster/raster_maker.h"
#include "testing/temporary_folder.h"
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/camera/world_camera.h"
#include "pilotage/raster/gdal_gray.h"
#include "pilotage/raster/gray_stretch.h"
#include "pilotage/replay/log_frames.h"

namespace pilotage {
namespace {

constexpr double kAgl_m = 70;
const Camera kLogCamera{80, 60, 70, 70, 40, 30};

/// 200 m of imagery, half a metre a pixel, and ground that rises by a third to the east.
struct LogWorld {
  testing::TemporaryFolder folder;
  std::string imagery;
  std::string slope;
  GeodeticPoint middle;

  LogWorld() {
    testing::RasterSpec spec;
    spec.width = spec.height = 400;
    spec.value = [](int, int col, int row) {
      return 128 + 60 * std::sin(col * 0.31) + 50 * std::sin(row * 0.23 + col * 0.05);
    };
    imagery = make_raster(folder / "imagery.tif", spec);
    spec.type = GDT_Float32;
    spec.value = [](int, int col, int) { return 100 + (col - 200) * 0.5 / 3; };
    slope = make_raster(folder / "slope.tif", spec);
    middle = *CrsTransform(testing::utm33()).geodetic_from_map({500100, 4'999'900});
  }

  LogFrames frames() const {
    LogFrames frames;
    for (const double yaw_deg : {0.0, 120.0}) {
      FrameRecord row;
      row.true_nadir = middle;
      row.height_agl_m = kAgl_m;
      frames.rows.push_back(row);
      frames.true_agl_m.push_back(kAgl_m);
      frames.true_attitude.push_back({yaw_deg, 5, -3});
    }
    return frames;
  }

  cv::Mat rendered(const std::string& elevation, std::size_t which) const {
    LogFrames all = frames();
    render_log_frames(all, kLogCamera, imagery, elevation, folder.path(), 2, {});
    EXPECT_NE(all.notes.back().find(elevation.empty() ? "flat ground" : elevation), std::string::npos);
    return cv::imread((folder / all.rows[which].file).string(), cv::IMREAD_UNCHANGED);
  }
};

TEST(RenderLogFrames, ShowTheGroundsHeightsWhereThereAreAny) {
  const LogWorld world;
  const cv::Mat flat = world.rendered("", 1);
  const cv::Mat sloped = world.rendered(world.slope, 1);
  ASSERT_EQ(sloped.size(), cv::Size(80, 60));
  EXPECT_GT(cv::norm(flat, sloped, cv::NORM_L1) / 4800, 5);
  const RenderedWorld same{stretch_to_8bit(open_gray(world.imagery)), world.slope};
  const CameraPose pose{world.middle, kAgl_m, kNaN, {120, 5, -3}};
  EXPECT_EQ(cv::norm(WorldCamera(same, kLogCamera).frame_at(pose).gray, sloped, cv::NORM_INF), 0);
}

TEST(RenderLogFrames, LeavesOutWhatTheImageryDoesNotCover) {
  const LogWorld world;
  LogFrames frames = world.frames();
  frames.rows[0].true_nadir->lon_deg += 0.01;
  render_log_frames(frames, kLogCamera, world.imagery, "", world.folder.path(), 1, {});
  ASSERT_EQ(frames.rows.size(), 1U);
  EXPECT_EQ(frames.rows[0].file, "frame_2.png");
  EXPECT_EQ(frames.true_attitude[0].yaw_deg, 120);
  EXPECT_NE(frames.notes.back().find("1 that imagery or heights do not cover"), std::string::npos);
  frames.rows[0].true_nadir->lon_deg += 0.01;
  EXPECT_THROW(render_log_frames(frames, kLogCamera, world.imagery, "", world.folder.path(), 1, {}), DataError);
}

}  // namespace
}  // namespace pilotage
