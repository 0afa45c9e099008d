#include "pilotage/camera/render_frame.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/LU>
#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/text.h"
#include "pilotage/camera/projection.h"
#include "pilotage/camera/sampled_ground.h"
#include "pilotage/geo/bounds.h"
#include "pilotage/geo/enu_from_grid.h"

namespace pilotage {
namespace {

constexpr double kJacobianStepPx = 256;
constexpr double kLeastDrop_m = 1e-3;
constexpr double kMarginPx = 4;                   // taps, and the bulge of a bent edge between points of the outline
constexpr double kMaxWindowPx = double{1 << 28};  // a footprint larger than this is a mistake

View checked_view(const Camera& camera, const Attitude& attitude, double agl_m) {
  if (const std::string problem = camera_problem(camera); !problem.empty()) throw UsageError("camera: " + problem);
  auto view = make_view(camera, attitude, agl_m);
  if (view) return *view;
  throw UsageError("attitude " + format_number(attitude.yaw_deg) + ", " + format_number(attitude.pitch_deg) + ", " +
                   format_number(attitude.roll_deg) + " deg or height " + format_number(agl_m) +
                   " m: finite angles and a height in (0, 1e6] are needed");
}

Bounds outline_bounds(const Footprint& seen, const GroundPlace& place) {
  Bounds bounds;
  for (const auto& point : seen.polygon_m) bounds.extend(place.pixel_from_ground(point));
  return bounds;
}

/// The part of the ground within `bounds`, in its pixels; of no width or height when they do not meet.
PixelWindow window_within(const Bounds& bounds, const GraySource& ground) {
  if (bounds.empty()) return {};
  const double left = std::max(0.0, std::floor(bounds.min_x_m));
  const double top = std::max(0.0, std::floor(bounds.min_y_m));
  const double width = std::min(static_cast<double>(ground.width_px), std::ceil(bounds.max_x_m)) - left;
  const double height = std::min(static_cast<double>(ground.height_px), std::ceil(bounds.max_y_m)) - top;
  if (!(width >= 1 && height >= 1)) return {};
  if (width * height > kMaxWindowPx) {
    throw UsageError("the footprint covers " + format_number(width) + " x " + format_number(height) +
                     " pixels of the ground; at most 2^28 can be rendered");
  }
  return {static_cast<std::int64_t>(left), static_cast<std::int64_t>(top), static_cast<int>(width),
          static_cast<int>(height)};
}

/// The rays of a row of corners of a lens's pixels.
void add_row_of_rays(const Lens& lens, int row, std::vector<Eigen::Vector3d>& rays) {
  for (int col = 0; col <= lens.camera.width_px; ++col) {
    const auto ray = ray_from_pixel(lens, Eigen::Vector2d(col, row));
    rays.push_back(ray ? *ray : Eigen::Vector3d(kNaN, kNaN, kNaN));
  }
}

/// Gives the rays of the corners of a view's pixels, row by row.
class CornerRays {
 public:
  CornerRays(const View& view, const std::vector<Eigen::Vector3d>* known) : view_(view), known_(known) {
    if (known != nullptr && known->size() != (width() * (static_cast<std::size_t>(view.lens.camera.height_px) + 1))) {
      throw UsageError("the rays of the corners are of another camera");
    }
  }

  std::span<const Eigen::Vector3d> row(int row) {
    if (known_ != nullptr) return std::span(*known_).subspan(static_cast<std::size_t>(row) * width(), width());
    row_.clear();
    add_row_of_rays(view_.lens, row, row_);
    return row_;
  }

 private:
  std::size_t width() const { return static_cast<std::size_t>(view_.lens.camera.width_px) + 1; }

  const View& view_;
  const std::vector<Eigen::Vector3d>* known_;
  std::vector<Eigen::Vector3d> row_;
};

/// Where rays meet the ground, in its pixels; NaN where they do not.
template <class MeetGround>
void find_corners(std::span<const Eigen::Vector3d> rays, const GroundPlace& place, const MeetGround& meet_ground,
                  std::vector<Eigen::Vector2d>& ground_m, CornerLine& corners) {
  ground_m.resize(rays.size());
  meet_ground(rays, ground_m);
  corners.x_px.resize(rays.size());
  corners.y_px.resize(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Eigen::Vector2d at_px = place.pixel_from_ground(ground_m[i]);
    corners.x_px[i] = at_px.x();
    corners.y_px[i] = at_px.y();
  }
}

/// `bounds` hold, in pixels of the ground, all that `meet_ground` gives: rays → metres east and north, NaN without any.
template <class MeetGround>
RenderedFrame render_pixels(const GraySource& ground, const GroundPlace& place, const Camera& camera,
                            const Bounds& bounds, CornerRays rays, const MeetGround& meet_ground) {
  if (ground.depth != CV_8U) throw UsageError("the ground has not 8 bits; stretch_to_8bit makes it so");
  RenderedFrame frame;
  frame.gray = cv::Mat(camera.height_px, camera.width_px, CV_8UC1, cv::Scalar(0));
  frame.valid = frame.gray.clone();
  const PixelWindow window = window_within(bounds, ground);
  if (window.width == 0) return frame;
  const Raster pixels = ground.read(window);
  const SampledGround sampled(pixels);

  GroundPlace in_window = place;
  in_window.nadir_px -= Eigen::Vector2d(static_cast<double>(window.col), static_cast<double>(window.row));
  std::vector<Eigen::Vector2d> ground_m;
  CornerLine above;
  CornerLine below;
  std::vector<double> means(static_cast<std::size_t>(camera.width_px));
  find_corners(rays.row(0), in_window, meet_ground, ground_m, above);
  for (int row = 0; row < frame.gray.rows; ++row) {
    find_corners(rays.row(row + 1), in_window, meet_ground, ground_m, below);
    sampled.means_between(above, below, means);
    auto* gray = frame.gray.ptr<std::uint8_t>(row);
    auto* valid = frame.valid.ptr<std::uint8_t>(row);
    for (std::size_t col = 0; col < means.size(); ++col) {
      if (std::isnan(means[col])) continue;
      gray[col] = cv::saturate_cast<std::uint8_t>(means[col]);
      valid[col] = 255;
    }
    std::swap(above, below);
  }
  frame.valid_fraction = static_cast<double>(cv::countNonZero(frame.valid)) / static_cast<double>(frame.valid.total());
  return frame;
}

}  // namespace

GeodeticPoint geodetic_from_pixel(const CrsTransform& transform, const GeoTransform& map_from_pixel,
                                  const Eigen::Vector2d& pixel) {
  const auto point = transform.geodetic_from_map(map_from_pixel.map_from_pixel(pixel));
  if (point) return *point;
  throw DataError("pixel (" + format_number(pixel.x()) + ", " + format_number(pixel.y()) +
                  ") of the ground has no longitude and latitude");
}

GroundPlace ground_place(const Crs& crs, const GeoTransform& map_from_pixel, const Eigen::Vector2d& nadir_px) {
  return ground_place(CrsTransform(crs), map_from_pixel, nadir_px);
}

GroundPlace ground_place(const CrsTransform& transform, const GeoTransform& map_from_pixel,
                         const Eigen::Vector2d& nadir_px) {
  // Pixels with rows counted upwards stand in for a grid in metres: enu_from_grid wants a right-handed one.
  const double hand = map_from_pixel.determinant() < 0 ? -1 : 1;
  const Eigen::Matrix2d enu_from_pixel =
      enu_from_grid({nadir_px.x(), hand * nadir_px.y()}, kJacobianStepPx, [&](const Eigen::Vector2d& point) {
        return transform.geodetic_from_map(map_from_pixel.map_from_pixel({point.x(), hand * point.y()}));
      });
  GroundPlace place;
  place.nadir_px = nadir_px;
  place.pixel_from_enu_m = Eigen::Vector2d(1, hand).asDiagonal() * enu_from_pixel.inverse();
  return place;
}

std::vector<Eigen::Vector3d> corner_rays(const Camera& camera) {
  const Lens lens = make_lens(camera);
  std::vector<Eigen::Vector3d> rays;
  rays.reserve((static_cast<std::size_t>(camera.width_px) + 1) * (static_cast<std::size_t>(camera.height_px) + 1));
  for (int row = 0; row <= camera.height_px; ++row) add_row_of_rays(lens, row, rays);
  return rays;
}

RenderedFrame render_frame(const GraySource& ground, const GroundPlace& place, const Camera& camera,
                           const Attitude& attitude, double agl_m, const std::vector<Eigen::Vector3d>* rays) {
  const View view = checked_view(camera, attitude, agl_m);
  return render_pixels(ground, place, camera, outline_bounds(footprint(view), place).grown(kMarginPx), {view, rays},
                       [&](std::span<const Eigen::Vector3d> row, std::span<Eigen::Vector2d> ground_m) {
                         for (std::size_t i = 0; i < row.size(); ++i) {
                           ground_m[i] = ground_from_ray(view, row[i]).value_or(Eigen::Vector2d(kNaN, kNaN));
                         }
                       });
}

RenderedFrame render_terrain_frame(const GraySource& ground, const GroundPlace& place, const Camera& camera,
                                   const Attitude& attitude, double agl_m, const TerrainHeights& terrain,
                                   const std::vector<Eigen::Vector3d>* rays) {
  const View view = checked_view(camera, attitude, agl_m);
  // A ray meets the ground between where it would on ground as high as the highest and as low as the lowest.
  Bounds bounds;
  for (const double height_m : {terrain.lowest_m(), std::min(terrain.highest_m(), agl_m - kLeastDrop_m)}) {
    View flat = view;
    flat.agl_m = agl_m - height_m;
    if (!(flat.agl_m > 0)) continue;
    for (const auto& point : footprint(flat).polygon_m) bounds.extend(place.pixel_from_ground(point));
  }
  return render_pixels(ground, place, camera, bounds.grown(kMarginPx), {view, rays},
                       [&](std::span<const Eigen::Vector3d> row, std::span<Eigen::Vector2d> ground_m) {
                         terrain_from_rays(view, terrain, row, ground_m);
                       });
}

bool footprint_inside(const GraySource& ground, const GroundPlace& place, const Camera& camera,
                      const Attitude& attitude, double agl_m) {
  const Footprint seen = footprint(checked_view(camera, attitude, agl_m));
  if (seen.polygon_m.empty() || seen.cut) return false;
  const Bounds bounds = outline_bounds(seen, place);
  return bounds.min_x_m >= 0 && bounds.min_y_m >= 0 && bounds.max_x_m <= static_cast<double>(ground.width_px) &&
         bounds.max_y_m <= static_cast<double>(ground.height_px);
}

}  // namespace pilotage
