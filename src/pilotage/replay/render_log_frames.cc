#include <memory>
#include <utility>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/parallel.h"
#include "pilotage/camera/world_camera.h"
#include "pilotage/raster/gdal_gray.h"
#include "pilotage/raster/gray_stretch.h"
#include "pilotage/replay/log_frames.h"

namespace pilotage {
namespace {

constexpr double kLeastShown = 0.999;  // of a frame, as cut_flight_frames takes it

/// False where imagery or heights do not cover the frame.
bool render_one(const WorldCamera& camera, const CameraPose& pose, const std::filesystem::path& path) {
  if (!camera.is_over_imagery(pose)) return false;
  const RenderedFrame frame = camera.frame_at(pose);
  if (frame.valid_fraction < kLeastShown) return false;
  if (!cv::imwrite(path.string(), frame.gray)) throw DataError(path.string() + ": cannot be written");
  return true;
}

}  // namespace

void render_log_frames(LogFrames& frames, const Camera& camera, const std::string& imagery,
                       const std::string& elevation, const std::filesystem::path& folder, int threads,
                       const Progress& progress) {
  const RenderedWorld world{stretch_to_8bit(open_gray(imagery)), elevation, false};
  std::vector<std::unique_ptr<WorldCamera>> cameras(static_cast<std::size_t>(thread_count(threads)));
  std::vector<char> shown(frames.rows.size(), 0);
  report_progress(progress, "rendering frames", 0, 0);
  parallel_for(frames.rows.size(), threads, [&](std::size_t i, int worker) {
    FrameRecord& row = frames.rows[i];
    row.file = "frame_" + std::to_string(i + 1) + ".png";
    if (!row.true_nadir) return;
    std::unique_ptr<WorldCamera>& own = cameras[static_cast<std::size_t>(worker)];
    if (!own) own = std::make_unique<WorldCamera>(world, camera);
    const CameraPose pose{*row.true_nadir, frames.true_agl_m[i], kNaN, frames.true_attitude[i]};
    shown[i] = render_one(*own, pose, folder / row.file) ? 1 : 0;
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
    throw DataError(imagery + (elevation.empty() ? "" : " with " + elevation) + ": shows the ground of none of the " +
                    std::to_string(shown.size()) + " places of the log whole");
  }
  kept.notes.push_back(
      std::to_string(kept.rows.size()) + " frames rendered from " + imagery +
      (elevation.empty() ? " over flat ground" : " over the heights of " + elevation) +
      (missing > 0 ? ", " + std::to_string(missing) + " that imagery or heights do not cover left out" : ""));
  frames = std::move(kept);
}

}  // namespace pilotage
