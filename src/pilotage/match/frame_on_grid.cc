#include "pilotage/match/frame_on_grid.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <opencv2/core.hpp>

#include "pilotage/camera/projection.h"
#include "pilotage/match/frame_grid.h"

namespace pilotage {
namespace {

constexpr double kMaxHalfWidthPx = 4096;  // of the search square: its histogram takes 64 MiB

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
  return options.search_sigmas * prior.sigma_m +
         2 * prior.height_agl_m * std::tan(options.attitude_sigma_deg * kRadPerDeg);
}

Attitude attitude_on_grid(const Attitude& attitude, const LocalGrid& grid) {
  return {attitude.yaw_deg - grid.convergence_deg(), attitude.pitch_deg, attitude.roll_deg};
}

FrameOnGrid lay_frame_on_grid(const cv::Mat& frame, const MatchPrior& prior, const Camera& camera, MapReader& map,
                              const MatchOptions& options) {
  FrameOnGrid laid;
  laid.level = level_for_height(map, prior.height_agl_m);
  if (laid.level == nullptr) {
    laid.refusal = MatchStatus::kNoMap;
    return laid;
  }
  const double half_width_m = search_half_width_m(prior, options);
  const double reach_m = std::min(half_width_m * std::numbers::sqrt2 + laid.level->max_tile_radius_m, 1e5);
  const auto grid = local_grid(map, *laid.level, prior.position, reach_m);
  if (!grid) {
    laid.refusal = MatchStatus::kNoMap;
    return laid;
  }
  laid.grid = *grid;
  laid.gsd_m = grid->gsd_m();
  laid.half_width_px = half_width_m / laid.gsd_m;
  if (laid.half_width_px > kMaxHalfWidthPx) {
    laid.refusal = MatchStatus::kBadPrior;
    return laid;
  }
  laid.prior_px = grid->px_from_geodetic(prior.position);

  const Attitude on_grid = attitude_on_grid(prior.attitude, *grid);
  RectifyOptions rectify;
  rectify.gsd_m = laid.gsd_m;
  rectify.max_size_px = kMaxRectifiedSidePx;
  laid.frame = ortho_rectify(frame, camera, on_grid, prior.height_agl_m, rectify);
  laid.refusal = refusal_of(laid.frame.status);
  if (laid.refusal) return laid;
  const auto view = make_view(camera, on_grid, prior.height_agl_m);
  const auto principal = view ? ground_from_pixel(*view, {camera.cx_px, camera.cy_px}) : std::nullopt;
  const cv::Size size = laid.frame.gray.size();
  laid.pivot_m = principal.value_or(laid.frame.ground_from_pixel({size.width / 2.0, size.height / 2.0}));
  return laid;
}

PivotedFrame describe(const FrameOnGrid& laid, const FeatureOptions& options) {
  PivotedFrame frame;
  frame.grid = describe_frame_grid(laid.frame, options);
  frame.pivot_px = laid.frame.pixel_from_ground(laid.pivot_m);
  for (const Feature& point : frame.grid.points.features) {
    const Eigen::Vector2d place(static_cast<double>(point.x_px), static_cast<double>(point.y_px));
    frame.radius_px = std::max(frame.radius_px, (place - frame.pivot_px).norm());
  }
  return frame;
}

SearchSpace search_space(const FrameOnGrid& laid, const LocalMap& map, const MatchOptions& options, bool oriented) {
  SearchSpace space;
  space.center_px = laid.prior_px + laid.px_from_m(laid.pivot_m) - map.reference_px;
  space.half_width_px = laid.half_width_px;
  space.yaw_sigma_rad = options.yaw_sigma_deg * kRadPerDeg;
  space.scale_sigma = options.height_sigma_fraction;
  space.oriented = oriented;
  return space;
}

}  // namespace pilotage
