#include "pilotage/camera/ortho_rectify.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"
#include "pilotage/camera/projection.h"
#include "pilotage/geo/bounds.h"

namespace pilotage {
namespace {

constexpr int kMaxFrameSidePx = 32766;  // cv::remap counts in 16 bits

RectifyStatus check_inputs(const cv::Mat& frame, const Camera& camera, const Attitude& attitude, double agl_m,
                           const RectifyOptions& options) {
  // Spelt out instead of check_options(), which throws.
  if (!(options.gsd_m >= 1e-3 && options.gsd_m <= 1e3)) return RectifyStatus::kBadOptions;
  if (options.max_size_px < 1 || options.max_size_px > 16384) return RectifyStatus::kBadOptions;
  if (!(options.max_off_nadir_deg >= 1 && options.max_off_nadir_deg <= 80)) return RectifyStatus::kBadOptions;
  if (!camera_problem(camera).empty()) return RectifyStatus::kBadCamera;
  if (frame.dims != 2 || frame.empty() || frame.type() != CV_8UC1) return RectifyStatus::kBadFrame;
  if (frame.cols != camera.width_px || frame.rows != camera.height_px) return RectifyStatus::kBadFrame;
  if (std::max(frame.cols, frame.rows) > kMaxFrameSidePx) return RectifyStatus::kBadFrame;
  if (!std::isfinite(attitude.yaw_deg) || !std::isfinite(attitude.pitch_deg) || !std::isfinite(attitude.roll_deg)) {
    return RectifyStatus::kBadAttitude;
  }
  if (!(agl_m > 0 && agl_m <= 1e6)) return RectifyStatus::kBadHeight;
  return RectifyStatus::kOk;
}

/// The result's pixels in whole multiples of the GSD: columns from west, rows from north.
struct Grid {
  std::int64_t min_col = 0;
  std::int64_t min_row = 0;
  int width = 0;
  int height = 0;
  bool cut = false;
};

/// First and number of pixels of one axis that cover [min_m, max_m], at most `max_size` about the middle.
struct Span {
  std::int64_t first;
  int count;
  bool cut;
};

Span whole_pixels(double min_m, double max_m, double gsd_m, int max_size) {
  const double low = std::floor(min_m / gsd_m);
  const double high = std::ceil(max_m / gsd_m);
  if (high - low <= max_size) return {static_cast<std::int64_t>(low), static_cast<int>(high - low), false};
  const double middle = std::round((min_m + max_m) / 2 / gsd_m);
  return {static_cast<std::int64_t>(middle) - max_size / 2, max_size, true};
}

Grid result_grid(const Footprint& footprint, const RectifyOptions& options) {
  Bounds bounds;
  for (const auto& point : footprint.polygon_m) bounds.extend(point);
  const Span x = whole_pixels(bounds.min_x_m, bounds.max_x_m, options.gsd_m, options.max_size_px);
  const Span y = whole_pixels(-bounds.max_y_m, -bounds.min_y_m, options.gsd_m, options.max_size_px);
  return {x.first, y.first, x.count, y.count, footprint.cut || x.cut || y.cut};
}

/// How many pixels of the frame one pixel of the result covers along a side, at a ground point that the frame shows:
/// the root of the area ratio, by central differences over one pixel of the result. 1 when it cannot be told.
double frame_pixels_per_result_pixel(const View& view, const Eigen::Vector2d& ground_m, double gsd_m) {
  const double half = gsd_m / 2;
  const auto west = pixel_from_ground(view, ground_m - Eigen::Vector2d(half, 0));
  const auto east = pixel_from_ground(view, ground_m + Eigen::Vector2d(half, 0));
  const auto south = pixel_from_ground(view, ground_m - Eigen::Vector2d(0, half));
  const auto north = pixel_from_ground(view, ground_m + Eigen::Vector2d(0, half));
  if (!west || !east || !south || !north) return 1;
  const Eigen::Vector2d by_x = *east - *west;
  const Eigen::Vector2d by_y = *north - *south;
  const double area = std::abs(by_x.x() * by_y.y() - by_x.y() * by_y.x());
  return std::isfinite(area) ? std::max(1.0, std::sqrt(area)) : 1;
}

/// The frame averaged down by `factor` ≥ 1 in each direction.
cv::Mat averaged(const cv::Mat& frame, double factor) {
  const int width = std::max(1, static_cast<int>(std::lround(frame.cols / factor)));
  const int height = std::max(1, static_cast<int>(std::lround(frame.rows / factor)));
  if (width == frame.cols && height == frame.rows) return frame;
  cv::Mat small;
  cv::resize(frame, small, cv::Size(width, height), 0, 0, cv::INTER_AREA);
  return small;
}

/// For each pixel of the result its place in the frame of `view`, in OpenCV's coordinates (first centre at 0), and
/// whether the frame holds all that linear interpolation needs there.
struct PixelMap {
  cv::Mat x;
  cv::Mat y;
  cv::Mat valid;
};

PixelMap map_to_frame(const View& view, const Grid& grid, double gsd_m) {
  constexpr int kTogether = kPointsTogether;
  PixelMap map{cv::Mat(grid.height, grid.width, CV_32FC1), cv::Mat(grid.height, grid.width, CV_32FC1),
               cv::Mat::zeros(grid.height, grid.width, CV_8UC1)};
  const double max_x = view.lens.camera.width_px - 1;
  const double max_y = view.lens.camera.height_px - 1;
  for (int row = 0; row < grid.height; ++row) {
    auto* const x = map.x.ptr<float>(row);
    auto* const y = map.y.ptr<float>(row);
    auto* const valid = map.valid.ptr<std::uint8_t>(row);
    const double north_m = -(static_cast<double>(grid.min_row + row) + 0.5) * gsd_m;
    for (int first = 0; first < grid.width; first += kTogether) {
      std::array<double, kPointsTogether> east_m{};
      for (std::size_t i = 0; i < kPointsTogether; ++i) {
        east_m[i] = (static_cast<double>(grid.min_col + first) + static_cast<double>(i) + 0.5) * gsd_m;
      }
      const PixelsTogether pixels = pixels_from_ground(view, east_m, north_m);
      for (int col = first; col < std::min(first + kTogether, grid.width); ++col) {
        const auto i = static_cast<std::size_t>(col - first);
        const double frame_x = pixels.x_px[i] - 0.5;
        const double frame_y = pixels.y_px[i] - 0.5;
        const bool shows = pixels.seen[i] && frame_x >= 0 && frame_x <= max_x && frame_y >= 0 && frame_y <= max_y;
        x[col] = shows ? static_cast<float>(frame_x) : -1;
        y[col] = shows ? static_cast<float>(frame_y) : -1;
        valid[col] = shows ? 255 : 0;
      }
    }
  }
  return map;
}

}  // namespace

std::string_view rectify_status_text(RectifyStatus status) {
  switch (status) {
    case RectifyStatus::kOk:
      return "rectified";
    case RectifyStatus::kBadOptions:
      return "an option of the rectification is outside its range";
    case RectifyStatus::kBadCamera:
      return "the camera cannot be used";
    case RectifyStatus::kBadFrame:
      return "the frame is not an 8-bit gray image of the camera's size";
    case RectifyStatus::kBadAttitude:
      return "the attitude is not finite";
    case RectifyStatus::kBadHeight:
      return "the height above ground is not above 0 and at most 1,000 km";
    case RectifyStatus::kNoGround:
      return "the frame shows no ground";
  }
  return "unknown status";
}

RectifiedFrame ortho_rectify(const cv::Mat& frame, const Camera& camera, const Attitude& attitude, double agl_m,
                             const RectifyOptions& options) {
  RectifiedFrame result;
  result.status = check_inputs(frame, camera, attitude, agl_m, options);
  if (result.status != RectifyStatus::kOk) return result;
  result.status = RectifyStatus::kNoGround;

  const auto view = make_view(camera, attitude, agl_m, options.max_off_nadir_deg);
  if (!view) return result;
  const Footprint seen = footprint(*view);
  if (seen.polygon_m.empty()) return result;
  const Grid grid = result_grid(seen, options);
  if (grid.width < 1 || grid.height < 1) return result;

  const double factor = frame_pixels_per_result_pixel(*view, seen.center_m, options.gsd_m);
  const cv::Mat small = averaged(frame, factor);
  const auto small_view =
      make_view(resized_camera(camera, small.cols, small.rows), attitude, agl_m, options.max_off_nadir_deg);
  if (!small_view) return result;
  const PixelMap map = map_to_frame(*small_view, grid, options.gsd_m);
  if (cv::countNonZero(map.valid) == 0) return result;

  cv::remap(small, result.gray, map.x, map.y, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  result.gray.setTo(0, map.valid == 0);
  result.valid = map.valid;
  result.gsd_m = options.gsd_m;
  result.origin_m = {static_cast<double>(grid.min_col) * options.gsd_m,
                     -static_cast<double>(grid.min_row) * options.gsd_m};
  result.cut = grid.cut;
  result.status = RectifyStatus::kOk;
  return result;
}

}  // namespace pilotage
