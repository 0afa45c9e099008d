#pragma once

#include <string>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pilotage/camera/world_camera.h"
#include "pilotage/mission/mission.h"

namespace pilotage {

/// The world of a mission: the raster `imagery` (another date of the same ground), or the mission's own imagery where
/// that is "", over `elevation`, or the mission's own where that is "". Throws DataError as inspect_imagery, UsageError
/// for an `elevation` where the plan knows no heights above sea level.
RenderedWorld make_rendered_world(const Mission& mission, const std::string& imagery,
                                  const std::string& elevation = "");

/// Smears a frame as the motion of the aircraft does while the shutter is open: the mean of copies along the way that
/// the middle of the picture moves, half a pixel apart or closer, about where it is. Motions below a tenth of a pixel
/// change nothing, longer ones than kMostMotion_px count as so long.
void blur_by_motion(cv::Mat& gray, const Eigen::Vector2d& motion_px);

inline constexpr double kMostMotion_px = 200;

/// How far the ground in the middle of the image moves across it while the aircraft moves `way_m` (east, north); zero
/// where the middle shows no ground.
Eigen::Vector2d motion_in_image(const Camera& camera, const CameraPose& pose, const Eigen::Vector2d& way_m);

}  // namespace pilotage
