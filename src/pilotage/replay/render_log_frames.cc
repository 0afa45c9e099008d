#include <algorithm>
#include <utility>

#include <opencv2/imgcodecs.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/parallel.h"
#include "pilotage/camera/render_frame.h"
#include "pilotage/raster/gdal_gray.h"
#include "pilotage/raster/gray_stretch.h"
#include "pilotage/replay/log_frames.h"

namespace pilotage {
namespace {

constexpr double kLeastShown = 0.999;  // of a frame, as cut_flight_frames takes it

/// False where the imagery does not cover the frame.
bool render_one(const GraySource& ground, const FrameRecord& row, double agl_m, const Attitude& attitude,
                const Camera& camera, const std::filesystem::path& path) {
  const auto nadir_map = CrsTransform(ground.crs).map_from_geodetic(*row.true_nadir);
  if (!nadir_map) return false;
  const GeoTransform& grid = ground.map_from_pixel;
  const GroundPlace place = ground_place(ground.crs, grid, grid.pixel_from_map(*nadir_map));
  if (!footprint_inside(ground, place, camera, attitude, agl_m)) return false;
  const RenderedFrame frame = render_frame(ground, place, camera, attitude, agl_m);
  if (frame.valid_fraction < kLeastShown) return false;
  if (!cv::imwrite(path.string(), frame.gray)) throw DataError(path.string() + ": cannot be written");
  return true;
}

}  // namespace

void render_log_frames(LogFrames& frames, const Camera& camera, const std::string& world,
                       const std::filesystem::path& folder, int threads, const Progress& progress) {
  const GraySource ground = stretch_to_8bit(open_gray(world));
  std::vector<char> shown(frames.rows.size(), 0);
  report_progress(progress, "rendering frames", 0, 0);
  parallel_for(frames.rows.size(), threads, [&](std::size_t i, int) {
    FrameRecord& row = frames.rows[i];
    row.file = "frame_" + std::to_string(i + 1) + ".png";
    if (!row.true_nadir) return;
    shown[i] =
        render_one(ground, row, frames.true_agl_m[i], frames.true_attitude[i], camera, folder / row.file) ? 1 : 0;
  });
  LogFrames kept;
  kept.notes = std::move(frames.notes);
  for (std::size_t i = 0; i < shown.size(); ++i) {
    if (shown[i] == 0) continue;
    kept.rows.push_back(std::move(frames.rows[i]));
    kept.true_agl_m.push_back(frames.true_agl_m[i]);
    kept.true_attitude.push_back(frames.true_attitude[i]);
  }
  const std::size_t missing = shown.size() - kept.rows.size();
  if (kept.rows.empty()) {
    throw DataError(world + ": shows the ground of none of the " + std::to_string(shown.size()) +
                    " places of the log whole");
  }
  kept.notes.push_back(std::to_string(kept.rows.size()) + " frames rendered from " + world +
                       (missing > 0 ? ", " + std::to_string(missing) + " that it does not cover left out" : ""));
  frames = std::move(kept);
}

}  // namespace pilotage
