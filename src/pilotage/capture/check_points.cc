#include "pilotage/capture/check_points.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "pilotage/base/error.h"
#include "pilotage/camera/lens.h"
#include "pilotage/capture/map_error.h"

namespace pilotage {
namespace {

constexpr double kSamePlace_m = 0.01;
constexpr double kNear_m = 0.001;

const ControlPoint::Mark& mark_of_map(const ControlPoint& point, const AdjustedBlock& block, std::size_t shown) {
  const auto away_m = [&](const ControlPoint::Mark& mark) {
    if (mark.frame == static_cast<int>(shown)) return -1.0;
    const FramePose& pose = block.poses[static_cast<std::size_t>(mark.frame)];
    return (pose.center_enu_m - point.enu_m).head<2>().norm();
  };
  return *std::min_element(point.marks.begin(), point.marks.end(),
                           [&](const auto& a, const auto& b) { return away_m(a) < away_m(b); });
}

/// Where a frame's pixel lies on the surface: rays look down, so that each round comes nearer.
std::optional<Eigen::Vector3d> place_of(const OrthoMosaic& mosaic, const Lens& lens, const ControlPoint::Mark& mark,
                                        const Eigen::Vector2d& start_en_m) {
  constexpr int kMostSteps = 30;
  const FramePose& pose = mosaic.block->poses[static_cast<std::size_t>(mark.frame)];
  const auto ray = ray_from_pixel(lens, mark.pixel);
  if (!ray) return std::nullopt;
  const Eigen::Vector3d direction = pose.enu_from_camera * *ray;
  if (direction.z() >= 0) return std::nullopt;
  Eigen::Vector3d place(start_en_m.x(), start_en_m.y(), 0);
  for (int round = 0; round < kMostSteps; ++round) {
    const double height_m = mosaic.ground->heights.height_m(place.head<2>());
    if (!std::isfinite(height_m)) return std::nullopt;
    const Eigen::Vector3d before = place;
    place = pose.center_enu_m + direction * ((height_m - pose.center_enu_m.z()) / direction.z());
    if ((place - before).norm() < kNear_m) return place;
  }
  return std::nullopt;  // ground as steep as the ray
}

}  // namespace

void refuse_adjusted_checks(const std::vector<ControlPoint>& checks, const std::vector<ControlPoint>& control_points) {
  for (const ControlPoint& check : checks) {
    for (const ControlPoint& control : control_points) {
      if ((check.enu_m - control.enu_m).head<2>().norm() < kSamePlace_m) {
        throw DataError("check point \"" + check.name + "\" is control point \"" + control.name +
                        "\" as well: it would check itself");
      }
    }
  }
}

std::vector<CheckedPoint> check_map(const std::vector<ControlPoint>& checks, const CaptureFrames& frames,
                                    const OrthoMosaic& mosaic, const MosaicStats& drawn) {
  const Lens lens = make_lens(mosaic.block->camera);
  const CrsTransform transform(mosaic.crs);
  std::vector<CheckedPoint> checked;
  for (const ControlPoint& point : checks) {
    const auto map_m = transform.map_from_geodetic(point_at(mosaic.frame, point.enu_m.head<2>()));
    const auto shown = map_m ? shown_frame(mosaic, drawn, *map_m) : std::nullopt;
    if (!shown) continue;
    const ControlPoint::Mark& mark = mark_of_map(point, *mosaic.block, *shown);
    const auto place_m = place_of(mosaic, lens, mark, point.enu_m.head<2>());
    if (!place_m) continue;
    CheckedPoint one;
    one.name = point.name;
    one.file = frames.frames[static_cast<std::size_t>(mark.frame)].frame.file;
    one.is_shown = mark.frame == static_cast<int>(*shown);
    one.miss_east_m = place_m->x() - point.enu_m.x();
    one.miss_north_m = place_m->y() - point.enu_m.y();
    one.map_sigma_m = std::sqrt(
        map_covariance_m2(*mosaic.block, *mosaic.ground, static_cast<std::size_t>(mark.frame), *place_m).trace() / 2);
    checked.push_back(std::move(one));
  }
  return checked;
}

}  // namespace pilotage
