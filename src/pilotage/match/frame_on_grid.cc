#include "pilotage/match/frame_on_grid.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include <opencv2/core.hpp>

#include "pilotage/camera/projection.h"
#include "pilotage/match/frame_grid.h"
#include "pilotage/match/landmark_matching.h"

namespace pilotage {
namespace {

std::optional<MatchStatus> refusal_of(RectifyStatus status) {
  switch (status) {
    case RectifyStatus::kOk:
      return std::nullopt;
    case RectifyStatus::kBadCamera:
      return MatchStatus::kBadCamera;
    case RectifyStatus::kBadAttitude:
    case RectifyStatus::kBadHeight:
      return MatchStatus::kBadPrior;
    case RectifyStatus::kNoGround:
      return MatchStatus::kNoGround;
    default:
      return MatchStatus::kBadFrame;
  }
}

}  // namespace

double search_half_width_m(const MatchPrior& prior, const MatchOptions& options) {
  return options.search_sigmas * largest_sigma_m(prior.covariance_en_m2) +
         2 * prior.height_agl_m * std::tan(options.attitude_sigma_deg * kRadPerDeg);
}

Attitude attitude_on_grid(const Attitude& attitude, const LocalGrid& grid) {
  return {attitude.yaw_deg - grid.convergence_deg(), attitude.pitch_deg, attitude.roll_deg};
}

FrameOnGrid rectify_frame(const cv::Mat& frame, const MatchPrior& prior, const Camera& camera, MapReader& map,
                          const MatchOptions& options, const Checkpoint& checkpoint) {
  FrameOnGrid rectified;
  rectified.level = level_for_height(map, prior.height_agl_m);
  if (rectified.level == nullptr) {
    rectified.refusal = MatchStatus::kNoMap;
    return rectified;
  }
  const double half_width_m = search_half_width_m(prior, options);
  const double reach_m = std::min(half_width_m * std::numbers::sqrt2 + rectified.level->max_tile_radius_m, 1e5);
  const auto grid = local_grid(map, *rectified.level, prior.position, reach_m);
  rectified.grid = grid ? *grid : plain_grid(*rectified.level, prior.position);
  // Of a frame as wide as any; of one that looks far ahead the landmarks there are not asked for.
  const double landmarks_m = landmark_reach(half_width_m, kMaxRectifiedSidePx * rectified.level->gsd_m);
  if (!grid && !has_landmark_within(map, options, prior.position, landmarks_m, checkpoint)) {
    rectified.refusal = MatchStatus::kNoMap;
    return rectified;
  }
  rectified.gsd_m = rectified.grid.gsd_m();
  rectified.half_width_px = half_width_m / rectified.gsd_m;
  if (rectified.half_width_px > kMaxHalfWidthPx) {
    rectified.refusal = MatchStatus::kTooUncertain;
    return rectified;
  }
  rectified.prior_px = rectified.grid.px_from_geodetic(prior.position);

  const Attitude on_grid = attitude_on_grid(prior.attitude, rectified.grid);
  RectifyOptions rectify;
  rectify.gsd_m = rectified.gsd_m;
  rectify.max_size_px = kMaxRectifiedSidePx;
  rectified.frame = ortho_rectify(frame, camera, on_grid, prior.height_agl_m, rectify);
  rectified.refusal = refusal_of(rectified.frame.status);
  if (rectified.refusal) return rectified;
  const auto view = make_view(camera, on_grid, prior.height_agl_m);
  const auto principal = view ? ground_from_pixel(*view, {camera.cx_px, camera.cy_px}) : std::nullopt;
  const cv::Size size = rectified.frame.gray.size();
  rectified.pivot_m = principal.value_or(rectified.frame.ground_from_pixel({size.width / 2.0, size.height / 2.0}));
  return rectified;
}

PivotedFrame describe(const FrameOnGrid& rectified, const FeatureOptions& options, const Checkpoint& checkpoint) {
  return pivoted_frame(rectified, describe_frame_grid(rectified.frame, options, FrameGrid::kUsualStepPx, checkpoint));
}

PivotedFrame pivoted_frame(const FrameOnGrid& rectified, FrameGrid grid) {
  PivotedFrame frame;
  frame.grid = std::move(grid);
  frame.pivot_px = rectified.frame.pixel_from_ground(rectified.pivot_m);
  frame.nadir_px = rectified.frame.pixel_from_ground({0, 0});
  for (const Feature& point : frame.grid.points.features) {
    const Eigen::Vector2d place(static_cast<double>(point.x_px), static_cast<double>(point.y_px));
    frame.radius_px = std::max(frame.radius_px, (place - frame.pivot_px).norm());
  }
  return frame;
}

SearchSpace search_space(const FrameOnGrid& rectified, const LocalMap& map, const MatchOptions& options) {
  SearchSpace space;
  space.center_px = rectified.prior_px + rectified.px_from_m(rectified.pivot_m) - map.reference_px;
  space.half_width_px = rectified.half_width_px;
  space.yaw_sigma_rad = options.yaw_sigma_deg * kRadPerDeg;
  constexpr double kMostScaleSigma = 0.5;  // two of them: down to nothing
  space.scale_sigma = std::min(std::hypot(options.height_sigma_fraction, map.relief.scale_sigma), kMostScaleSigma);
  return space;
}

}  // namespace pilotage
