#include "pilotage/camera/world_camera.h"

namespace pilotage {
namespace {

RenderedFrame nothing_seen(const Camera& camera) {
  RenderedFrame frame;
  frame.gray = cv::Mat::zeros(camera.height_px, camera.width_px, CV_8UC1);
  frame.valid = frame.gray.clone();
  return frame;
}

}  // namespace

WorldCamera::WorldCamera(const RenderedWorld& world, const Camera& camera)
    : world_(&world), camera_(camera), rays_(corner_rays(camera)), transform_(world.ground.crs) {
  if (!world.elevation.empty()) elevation_.emplace(world.elevation);
}

std::optional<GroundPlace> WorldCamera::place_below(const CameraPose& pose) const {
  const auto on_map = transform_.map_from_geodetic(pose.position);
  if (!on_map) return std::nullopt;
  const GeoTransform& grid = world_->ground.map_from_pixel;
  return ground_place(transform_, grid, grid.pixel_from_map(*on_map));
}

bool WorldCamera::is_over_imagery(const CameraPose& pose) const {
  const auto place = place_below(pose);
  return place && footprint_inside(world_->ground, *place, camera_, pose.attitude, pose.height_agl_m);
}

RenderedFrame WorldCamera::frame_at(const CameraPose& pose) const {
  const auto below = place_below(pose);
  if (!below) return nothing_seen(camera_);
  const GraySource& ground = world_->ground;
  const GroundPlace& place = *below;
  if (!elevation_) return render_frame(ground, place, camera_, pose.attitude, pose.height_agl_m, &rays_);
  const auto view = make_view(camera_, pose.attitude, pose.height_agl_m);
  // What is no view render_frame names as such.
  if (!view) return render_frame(ground, place, camera_, pose.attitude, pose.height_agl_m, &rays_);
  return render_terrain_frame(ground, place, camera_, pose.attitude, pose.height_agl_m,
                              terrain_under(*view, pose.position, *elevation_), &rays_);
}

double WorldCamera::ground_amsl_m(GeodeticPoint point) const {
  return elevation_ ? elevation_->amsl_m(point) : kNaN;
}

}  // namespace pilotage
