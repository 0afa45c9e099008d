#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "pilotage/base/progress.h"
#include "pilotage/mission/mission.h"
#include "pilotage/raster/gray_source.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// What the camera will see at a place of the route.
struct SeenFrame {
  double distance_m = 0;   ///< Along the route.
  double azimuth_deg = 0;  ///< Of the flight, clockwise from true north: the top of a level camera's picture.
  double agl_m = 0;
  double width_m = 0;               ///< Of the ground across the picture, of a camera that looks straight down.
  std::optional<std::size_t> tile;  ///< The tile of the ground that the frame is compared with (mission/tile_under.h).
};

/// Frames on one sheet of gray pixels (CV_8UC1): that of frames[i] has width_px × height_px pixels and begins at column
/// i % columns · step_x_px and row i / columns · step_y_px. Pixels that see no imagery are gray 192. No frames:
/// nothing.
struct SeenFrames {
  std::vector<SeenFrame> frames;  ///< In the order of the route.
  int width_px = 0;
  int height_px = 0;
  int step_x_px = 0;  ///< Whole JPEG blocks, so that pictures do not run into each other.
  int step_y_px = 0;
  int columns = 1;
  bool second_date = false;  ///< Rendered from the second date.
  cv::Mat sheet;

  cv::Rect place(std::size_t i) const {
    const int n = static_cast<int>(i);
    return {n % columns * step_x_px, n / columns * step_y_px, width_px, height_px};
  }
};

/// Frames are rendered at so many places at most, and have so many pixels along their longer side.
inline constexpr std::size_t kMostSeenFrames = 48;
inline constexpr int kSeenFrameSide_px = 192;

/// The imagery, or a second date, on the grid of a level, CV_8U.
using OpenLevel = std::function<GraySource(const GridLevel&)>;

/// Renders what the camera sees in level flight (camera/render_frame.h) in the middles of kMostSeenFrames equal
/// stretches of the route, and of fewer where it has fewer samples; none where the aircraft is too low for any level.
/// The same for any number of threads (0 = all cores). Throws DataError when the imagery cannot be read, Interrupted.
SeenFrames render_seen_frames(const Mission& mission, const OpenLevel& open, int threads = 0,
                              const Progress& progress = {});

/// From the mission's own imagery, stretched to 8 bits.
OpenLevel open_own_imagery(const Mission& mission);

}  // namespace pilotage

#pragma GCC visibility pop
