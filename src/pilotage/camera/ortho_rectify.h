#pragma once

#include <string_view>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pilotage/base/options.h"
#include "pilotage/camera/attitude.h"
#include "pilotage/camera/camera.h"

namespace pilotage {

struct RectifyOptions {
  double gsd_m = 0.6;
  int max_size_px = 4096;
  double max_off_nadir_deg = 65;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("gsd_m", self.gsd_m, "Ground length of one pixel of the result.", Range{1e-3, 1e3});
    fields.field("max_size_px", self.max_size_px, "Largest width and height of the result; ground beyond is cut off.",
                 Range{1, 16384});
    fields.field("max_off_nadir_deg", self.max_off_nadir_deg, "Ground seen more obliquely is left out.", Range{1, 80});
  }
};

enum class RectifyStatus {
  kOk,
  kBadOptions,   ///< An option is outside its range.
  kBadCamera,    ///< camera_problem() finds one.
  kBadFrame,     ///< Empty, not CV_8UC1, not of the camera's size, or a side above 32,766 px.
  kBadAttitude,  ///< Not finite.
  kBadHeight,    ///< Not in (0, 1e6] m.
  kNoGround,     ///< No part of the frame shows ground within max_off_nadir_deg, or less than one pixel of the result.
};

/// A sentence for people.
std::string_view rectify_status_text(RectifyStatus status);

/// A frame laid out north-up. Column 0 is west, row 0 north.
struct RectifiedFrame {
  RectifyStatus status = RectifyStatus::kNoGround;
  cv::Mat gray;   ///< CV_8UC1; 0 where not valid. Empty unless status is kOk.
  cv::Mat valid;  ///< CV_8UC1: 255 where the frame shows the ground of the pixel, else 0.
  double gsd_m = 0;
  /// East, north of the outer corner of the first pixel (top left), in metres from the point straight below the camera.
  /// A whole multiple of gsd_m, so that results of neighbouring frames share a pixel grid.
  Eigen::Vector2d origin_m{0, 0};
  bool cut = false;  ///< Ground was left out: horizon, max_off_nadir_deg or max_size_px.

  /// East, north of a pixel position (centres at +0.5).
  Eigen::Vector2d ground_from_pixel(const Eigen::Vector2d& pixel) const {
    return {origin_m.x() + pixel.x() * gsd_m, origin_m.y() - pixel.y() * gsd_m};
  }
  Eigen::Vector2d pixel_from_ground(const Eigen::Vector2d& ground_m) const {
    return {(ground_m.x() - origin_m.x()) / gsd_m, (origin_m.y() - ground_m.y()) / gsd_m};
  }
};

/// Undistorts `frame` and lays it on flat ground `agl_m` below the camera, north up at options.gsd_m. Where the frame
/// is finer than the result it is first averaged over areas (by the ratio at the footprint's centre), so that nothing
/// aliases; then each pixel of the result is projected into it in closed form and interpolated linearly (1/32 px
/// steps). Whatever frame, attitude or height is passed, the answer is a status: nothing is thrown but std::bad_alloc.
RectifiedFrame ortho_rectify(const cv::Mat& frame, const Camera& camera, const Attitude& attitude, double agl_m,
                             const RectifyOptions& options = {});

}  // namespace pilotage
